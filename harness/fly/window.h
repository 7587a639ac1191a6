/* SPDX-License-Identifier: MIT
 *
 * A window on the screen, its keys and its mouse, through SDL 2: window_sdl.c, or where its headers
 * were not there to build with, window_missing.c, which says so.
 *
 * The library is opened when a window is: nobody else waits for it to load, which takes as long as
 * all of `neph --version`, and a neph that was built for it runs where it is not.
 */
#ifndef NEPH_HARNESS_FLY_WINDOW_H
#define NEPH_HARNESS_FLY_WINDOW_H

#include "base/status.h"
#include "harness/fly/event.h"

#include <stdbool.h>
#include <stdint.h>

struct neph_window;

/* Whether the library can be opened: neph was built for it, and it is there. */
bool neph_window_has_library(void);

/* Open a window that shows pictures of this size; it may be made larger. NEPH_ERR_UNAVAILABLE: no
 * SDL, or no display; the hint is the way out. Free with _close. */
enum neph_status neph_window_open(const char *title, int width_px, int height_px,
                                  struct neph_window **window, struct neph_diag *diag);

/* NULL is fine. */
void neph_window_close(struct neph_window *window);

void neph_window_set_title(struct neph_window *window, const char *title);

/* Whether the pointer is hidden and only its motion is told. */
void neph_window_capture(struct neph_window *window, bool is_captured);

/* The next event; false: there is none now. */
bool neph_window_next(struct neph_window *window, struct neph_fly_event *event);

/* As if a person had pressed a key, or let go of it. */
void neph_window_push_key(struct neph_window *window, int key, bool is_down);

/* A picture of the window's own size, 3 bytes a pixel, row 0 on top. NEPH_ERR_ENGINE. */
enum neph_status neph_window_show(struct neph_window *window, const uint8_t *rgb,
                                  struct neph_diag *diag);

#endif

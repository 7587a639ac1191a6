/* SPDX-License-Identifier: MIT
 *
 * A window with keyboard and mouse, through SDL 2: window_sdl.c, or window_missing.c, which reports
 * an error, if neph was built without SDL's headers.
 *
 * The library is loaded when a window is opened. Loading takes as long as a whole `neph --version`,
 * so other verbs do not wait for it; and a neph built with SDL runs where SDL is not installed.
 */
#ifndef NEPH_HARNESS_FLY_WINDOW_H
#define NEPH_HARNESS_FLY_WINDOW_H

#include "base/status.h"
#include "harness/fly/event.h"

#include <stdbool.h>
#include <stdint.h>

struct neph_window;

/* Whether the library can be loaded: neph was built with it, and it is installed. */
bool neph_window_has_library(void);

/* Open a window for frames of this size; the user may enlarge it. NEPH_ERR_UNAVAILABLE: no SDL, or
 * no display; the hint says what to do. Free with neph_window_close(). */
enum neph_status neph_window_open(const char *title, int width_px, int height_px,
                                  struct neph_window **window, struct neph_diag *diag);

/* `window` may be NULL. */
void neph_window_close(struct neph_window *window);

void neph_window_set_title(struct neph_window *window, const char *title);

/* Hide the pointer and report only its motion. */
void neph_window_capture(struct neph_window *window, bool is_captured);

/* Take the next event; false: the queue is empty. */
bool neph_window_next(struct neph_window *window, struct neph_fly_event *event);

/* Insert a press or a release of a key into the event queue. */
void neph_window_push_key(struct neph_window *window, int key, bool is_down);

/* Show an image of the window's frame size, 3 bytes per pixel, row 0 on top. NEPH_ERR_ENGINE. */
enum neph_status neph_window_show(struct neph_window *window, const uint8_t *rgb,
                                  struct neph_diag *diag);

#endif

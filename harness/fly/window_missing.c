/* SPDX-License-Identifier: MIT
 *
 * Replaces window_sdl.c if neph was built without SDL's headers.
 */
#include "harness/fly/window.h"

bool neph_window_has_library(void)
{
    return false;
}

enum neph_status neph_window_open(const char *title, int width_px, int height_px,
                                  struct neph_window **window, struct neph_diag *diag)
{
    (void)title;
    (void)width_px;
    (void)height_px;
    (void)window;
    neph_fail(diag, NEPH_ERR_UNAVAILABLE, "this neph was built without SDL 2: it has no windows");
    neph_hint(diag, "apt-get install libsdl2-dev, and build it again");
    return NEPH_ERR_UNAVAILABLE;
}

void neph_window_close(struct neph_window *window)
{
    (void)window;
}

void neph_window_set_title(struct neph_window *window, const char *title)
{
    (void)window;
    (void)title;
}

void neph_window_capture(struct neph_window *window, bool is_captured)
{
    (void)window;
    (void)is_captured;
}

bool neph_window_next(struct neph_window *window, struct neph_fly_event *event)
{
    (void)window;
    (void)event;
    return false;
}

void neph_window_push_key(struct neph_window *window, int key, bool is_down)
{
    (void)window;
    (void)key;
    (void)is_down;
}

enum neph_status neph_window_show(struct neph_window *window, const uint8_t *rgb,
                                  struct neph_diag *diag)
{
    (void)window;
    (void)rgb;
    (void)diag;
    return NEPH_OK;
}

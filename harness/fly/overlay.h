/* SPDX-License-Identifier: MIT
 *
 * Draws the text over a frame.
 */
#ifndef NEPH_HARNESS_FLY_OVERLAY_H
#define NEPH_HARNESS_FLY_OVERLAY_H

#include "harness/fly/canvas.h"
#include "harness/fly/times.h"
#include "harness/fly/view.h"

#include <stdbool.h>

struct neph_overlay {
    const char *scene, *engine;
    const struct neph_view *view;
    double speed_m_per_s, frame_s, render_s;
    const struct neph_fly_passes *passes; /* NULL: not shown */
    bool is_paused, shows_help;
    int recorded_frames; /* below 0: no recording */
    const char *notice;  /* NULL: none */
};

void neph_overlay_draw(const struct neph_overlay *overlay, struct neph_canvas *canvas);

#endif

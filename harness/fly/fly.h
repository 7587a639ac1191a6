/* SPDX-License-Identifier: MIT
 *
 * `neph fly`: a scene in a window, flown through by hand.
 */
#ifndef NEPH_HARNESS_FLY_FLY_H
#define NEPH_HARNESS_FLY_FLY_H

#include "harness/fly/studio.h"
#include "harness/json.h"

struct neph_fly_params {
    struct neph_studio_params studio;
    const char *preset; /* of engine realtime; NULL: its defaults */
    const char *folder; /* for pictures and paths; it is there */
    const char *keys;   /* harness/fly/script.h; NULL: a person alone. Time then goes by a frame of
                           the scene a picture and not by the clock: the same flight anywhere */
    int frame_limit;    /* 0: until it is left */
};

/* Returns when the window is closed, when so many frames were shown, or after Ctrl-C. What is
 * recorded by then is written in any case. `*result`, also after Ctrl-C, is for json_decref():
 *   scene, engine, settings, device, size_px, frames
 *   frame_median_s   from one frame to the next, showing it included; null before two
 *   render_median_s  cost.render_s of engine.h
 *   camera           {position_m, look_at_m} at the end
 *   error            of the last frame, where the map of it was shown: {rel_bias, rel_rmse,
 *                    rays_per_px}; else null
 *   flicker          likewise: {frames, a4_mean, a4_share_1}
 *   files            what was written
 * Errors: as of neph_window_open() and neph_studio_open(); NEPH_ERR_USAGE: the keys; what a file
 * could not be written for, at the end; NEPH_ERR_UNSUPPORTED: an orthographic camera;
 * NEPH_ERR_INTERRUPTED. */
enum neph_status neph_fly(const struct neph_fly_params *params, json_t **result,
                          struct neph_diag *diag);

#endif

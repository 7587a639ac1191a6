/* SPDX-License-Identifier: MIT
 *
 * `neph fly`: shows a scene in a window with a camera that the user moves.
 */
#ifndef NEPH_HARNESS_FLY_FLY_H
#define NEPH_HARNESS_FLY_FLY_H

#include "harness/fly/studio.h"
#include "harness/json.h"

struct neph_fly_params {
    struct neph_studio_params studio;
    const char *preset; /* of engine realtime; NULL: its defaults */
    const char *folder; /* for screenshots and paths; exists */
    const char *keys;   /* scripted keys (harness/fly/script.h); NULL: none. With a script each
                         * rendered frame is one scene frame, independent of the clock: the same
                         * flight everywhere */
    int frame_limit;    /* 0: no limit */
};

/* Run until the window is closed, the frame limit is reached, or Ctrl-C. A path that is being
 * recorded is always written. `*result`, for json_decref(), is set after Ctrl-C as well:
 *   scene, engine, settings, device, size_px, frames
 *   frame_median_s   from one frame to the next, with its presentation; null before two frames
 *   render_median_s  cost.render_s of engine.h
 *   camera           {position_m, look_at_m} at the end
 *   error            of the last frame, if its error map was shown: {rel_bias, rel_rmse,
 *                    rays_per_px}; else null
 *   flicker          likewise: {frames, a4_mean, a4_share_1}
 *   files            the written files
 * Errors: as of neph_window_open() and neph_studio_open(); NEPH_ERR_USAGE: invalid keys; at the
 * end, the first error of writing a file; NEPH_ERR_UNSUPPORTED: an orthographic camera;
 * NEPH_ERR_INTERRUPTED. */
enum neph_status neph_fly(const struct neph_fly_params *params, json_t **result,
                          struct neph_diag *diag);

#endif

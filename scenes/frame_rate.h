/* SPDX-License-Identifier: MIT
 *
 * The same motion at another frame rate: at twice the rate a scene has twice the frames, and from
 * frame to frame everything moves by half.
 */
#ifndef NEPH_SCENES_FRAME_RATE_H
#define NEPH_SCENES_FRAME_RATE_H

#include "scenes/scene.h"

/* The reason for which a scene cannot have this frame rate, a static text; NULL: it can. A rate of
 * 0 is its own. */
const char *neph_frame_rate_obstacle(const struct neph_scene *scene, double rate_hz);

/* Moves all keys of a scene without an obstacle, so that camera, sun, lights, wind and
 * solids are at the same place at the same time, and computes its hash. The scene owns its keys.
 * Injections stay at their frames. Errors: neph_scene_hash(). */
enum neph_status neph_scene_set_frame_rate(struct neph_scene *scene, double rate_hz,
                                           struct neph_diag *diag);

#endif

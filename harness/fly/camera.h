/* SPDX-License-Identifier: MIT
 *
 * A camera that is flown by hand through a scene.
 */
#ifndef NEPH_HARNESS_FLY_CAMERA_H
#define NEPH_HARNESS_FLY_CAMERA_H

#include "scenes/scene.h"

/* What is asked of it in a frame. Ways are parts of the speed: -1..1, more when it is to be fast.
 */
struct neph_fly_motion {
    double right, up, forward; /* up: along the scene's own; the others as it looks */
    double turn_right_rad, turn_up_rad;
    double speed_factor; /* from now on */
    double time_s;       /* since the frame before */
};

struct neph_fly_camera {
    struct neph_camera_key key; /* as it would stand in a scene file; its frame is not used */
    double speed_m_per_s;
};

/* The camera of the scene's frame 0, to the last bit until it is moved, at a speed that takes two
 * seconds for the distance of what there is to see: the point that it looks at, or, when that is
 * farther, the nearest medium with finite bounds, whose thinnest side it is inside. */
struct neph_fly_camera neph_fly_camera_of(const struct neph_scene *scene);

/* It never looks straight up or down, stays within what a scene file may say (1e6 m) and does not
 * enter solids, so that its keys are those of a valid scene. What forbids a step leaves the
 * camera where it is. */
void neph_fly_camera_move(struct neph_fly_camera *camera, const struct neph_scene *scene,
                          const struct neph_fly_motion *motion);

/* Whether two keys are the same view, to the last bit. */
bool neph_fly_is_same_view(const struct neph_camera_key *a, const struct neph_camera_key *b);

#endif

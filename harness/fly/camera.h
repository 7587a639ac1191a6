/* SPDX-License-Identifier: MIT
 *
 * A camera that the user flies through a scene.
 */
#ifndef NEPH_HARNESS_FLY_CAMERA_H
#define NEPH_HARNESS_FLY_CAMERA_H

#include "scenes/scene.h"

/* The camera's motion in one frame. `right`, `up` and `forward` are factors of the speed: -1..1,
 * larger for fast motion.
 */
struct neph_fly_motion {
    double right, up, forward; /* up: along the scene's up axis; right, forward: relative to the
                                * view */
    double turn_right_rad, turn_up_rad;
    double speed_factor; /* multiplies the speed from now on */
    double time_s;       /* since the last frame */
};

struct neph_fly_camera {
    struct neph_camera_key key; /* as in a scene file; key.frame is not used */
    double speed_m_per_s;
};

/* The camera of the scene's frame 0, bit for bit until it is moved. Its speed covers in two seconds
 * the distance to the look-at point or, if that is farther, to the nearest medium with finite
 * bounds; inside a medium the shortest side of its bounds counts. */
struct neph_fly_camera neph_fly_camera_from_scene(const struct neph_scene *scene);

/* Move the camera. Its keys stay valid in a scene file: it never looks straight up or down, stays
 * within 1e6 m, and does not enter solids. A step that breaks one of these rules is not made. */
void neph_fly_camera_move(struct neph_fly_camera *camera, const struct neph_scene *scene,
                          const struct neph_fly_motion *motion);

/* Whether two keys show the same view, bit for bit. */
bool neph_fly_is_same_view(const struct neph_camera_key *a, const struct neph_camera_key *b);

#endif

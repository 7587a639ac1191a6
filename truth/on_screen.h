/* SPDX-License-Identifier: MIT
 *
 * The part of a scene that a frame shows: the only light and occluders of screen-space methods.
 */
#ifndef NEPH_TRUTH_ON_SCREEN_H
#define NEPH_TRUTH_ON_SCREEN_H

#include "scenes/scene.h"

struct neph_screen {
    struct neph_camera camera;
    double aspect; /* width / height */
};

/* Whether a point just outside a surface is visible: inside the frame, in front of the camera, and
 * not occluded by a solid. */
bool neph_is_on_screen(const struct neph_scene *scene, const struct neph_screen *screen,
                       struct neph_vec3 point_m);

#endif

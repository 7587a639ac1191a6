/* SPDX-License-Identifier: MIT
 *
 * The part of a scene that a frame shows: a screen-space method finds light and occluders nowhere
 * else.
 */
#ifndef NEPH_TRUTH_ON_SCREEN_H
#define NEPH_TRUTH_ON_SCREEN_H

#include "scenes/scene.h"

struct neph_screen {
    struct neph_camera camera;
    double aspect; /* width / height */
};

/* Whether a point just outside a surface is seen: within the picture, before the camera, and no
 * solid in between. */
bool neph_on_screen(const struct neph_scene *scene, const struct neph_screen *screen,
                    struct neph_vec3 point_m);

#endif

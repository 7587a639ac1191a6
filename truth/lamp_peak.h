/* SPDX-License-Identifier: MIT
 *
 * Pixels whose radiance is infinite: their ray goes through a point light in a medium that scatters
 * there. The light that the medium scatters into the ray goes with 1 / d^2 of the distance d from
 * the light, and the integral of that along the ray has no bound where d goes to 0. No number is
 * right for such a pixel; its neighbours have finite ones.
 */
#ifndef NEPH_TRUTH_LAMP_PEAK_H
#define NEPH_TRUTH_LAMP_PEAK_H

#include "scenes/scene.h"

/* Whether that is so for a light and a ray. A ray is said to go through a light that it passes
 * nearer than double precision can tell. */
bool neph_is_lamp_peak(const struct neph_scene *still, const struct neph_light *light,
                       struct neph_vec3 origin_m, struct neph_vec3 direction);

struct neph_lamp_peak {
    int light; /* index of it in the scene */
    int column, row;
    bool is_at_the_eye; /* the rays of many pixels begin at the light */
};

/* The first such pixel of a frame of a scene as it stands then (neph_scene_at()); false: there is
 * none. Costs a few operations a light, and one ray a pixel where a light is at the eye. */
bool neph_find_lamp_peak(const struct neph_scene *still, const struct neph_camera *camera,
                         int width_px, int height_px, struct neph_lamp_peak *peak);

#endif

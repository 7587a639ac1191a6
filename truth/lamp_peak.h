/* SPDX-License-Identifier: MIT
 *
 * Pixels with infinite radiance: their ray passes through a point light inside a scattering medium.
 * The in-scattered light is proportional to 1 / d^2 of the distance d from the light, and its
 * integral along the ray diverges where d goes to 0. No value is correct for such a pixel; its
 * neighbours have finite values.
 */
#ifndef NEPH_TRUTH_LAMP_PEAK_H
#define NEPH_TRUTH_LAMP_PEAK_H

#include "scenes/scene.h"

/* Whether this applies to a light and a ray: the ray passes the light nearer than double precision
 * can resolve. */
bool neph_is_light_peak(const struct neph_scene *still, const struct neph_light *light,
                        struct neph_vec3 origin_m, struct neph_vec3 direction);

struct neph_light_peak {
    int light; /* its index in the scene */
    int column, row;
    bool is_at_the_eye; /* the light is at the eye, where the rays of many pixels start */
};

/* Find the first such pixel of a frame; `still` is the scene at the frame's time (neph_scene_at()).
 * False: there is none. Costs a few operations per light, and one ray per pixel if a light is at
 * the eye. */
bool neph_find_light_peak(const struct neph_scene *still, const struct neph_camera *camera,
                          int width_px, int height_px, struct neph_light_peak *peak);

#endif

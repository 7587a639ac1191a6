/* SPDX-License-Identifier: MIT
 *
 * What a pixel's view ray meets, as lighting models need to know it, in double precision: optical
 * depths, the angle to the sun, and how much sunlight arrives along it at scaled optical depths.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_VIEW_H
#define NEPH_HARNESS_STUDY_LIGHT_VIEW_H

#include "scenes/scene.h"

/* Scales of the optical depths: 2^-k, and last of all 0. */
enum { NEPH_LIGHT_SCALES = 16 };

struct neph_light_view {
    double eye_depth; /* optical depth of the whole ray, to the first solid */
    /* Towards the sun from the middle of what is seen: the first place that half of the light which
     * the medium takes from the ray is lost before. Where nothing comes through, that is where the
     * transmittance is one half. +inf: a solid hides the sun there. NaN: nothing is there. */
    double sun_depth;
    double angle_rad; /* between the ray and the direction to the sun */
    /* Integral over the ray of sigma(s) e^(-scale (tau(0, s) + tau_sun(s))) ds, where the sun is
     * seen: single scattering of a medium that light passes more easily, without its phase function
     * and albedo. */
    double lit[NEPH_LIGHT_SCALES];
};

/* The k-th of NEPH_LIGHT_SCALES. */
double neph_light_scale(int k);

/* `lit` is NaN unless asked for: it takes a ray towards the sun for each of its steps. The sun is
 * there, and media are grey (scenes/relit.h). */
struct neph_light_view neph_light_view_of(const struct neph_scene *scene,
                                          const struct neph_pixel_ray *ray, bool with_lit);

/* The integral at any scale of 0..1, between those that are known: linear in its logarithm over
 * that of the scale. 0 stays 0. */
double neph_light_lit_at(const double lit[NEPH_LIGHT_SCALES], double scale);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The view ray of a pixel in double precision, for fits of lighting models: optical depths, angle
 * to the sun, and single-scattered sunlight at scaled optical depths.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_VIEW_H
#define NEPH_HARNESS_STUDY_LIGHT_VIEW_H

#include "scenes/scene.h"

/* Scales of the optical depth: 2^-k for k = 0, 1, ..., and 0 as the last one. */
enum { NEPH_LIGHT_SCALES = 16 };

struct neph_light_view {
    double eye_depth; /* optical depth of the whole ray, up to the first solid */
    /* Optical depth towards the sun from the middle of the visible medium: the point before which
     * the medium takes half of the light that it takes from the whole ray. For an opaque ray the
     * transmittance at this point is 1/2. +inf: a solid shadows the point. NaN: the ray meets no
     * medium. */
    double sun_depth;
    double angle_rad; /* between the ray and the direction to the sun */
    /* lit[k] = integral of sigma(s) e^(-scale_k (tau(0, s) + tau_sun(s))) ds over the sunlit parts
     * of the ray: single scattering in a medium with scaled extinction, without phase function and
     * albedo. */
    double lit[NEPH_LIGHT_SCALES];
};

/* The k-th of the NEPH_LIGHT_SCALES scales. */
double neph_light_scale(int k);

/* Computes the view of a pixel. `with_lit` false: `lit` is NaN, as each of its steps takes a ray
 * towards the sun. The scene has a sun, and its media are grey (scenes/relit.h). */
struct neph_light_view neph_light_view_compute(const struct neph_scene *scene,
                                               const struct neph_pixel_ray *ray, bool with_lit);

/* The integral at any scale in 0..1, interpolated between the known ones: linear in its logarithm
 * over the logarithm of the scale. A value of 0 stays 0. */
double neph_light_interpolate_lit(const double lit[NEPH_LIGHT_SCALES], double scale);

#endif

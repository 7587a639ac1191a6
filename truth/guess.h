/* SPDX-License-Identifier: MIT
 *
 * Sampling of singly scattered sunlight on a ray through media without closed forms: the
 * distribution of truth/lit_flight.h, from guessed optical depths that need few densities. The
 * guess affects only the sampling: densities at the sampled points are exact, transmittances are
 * estimated without bias.
 */
#ifndef NEPH_TRUTH_GUESS_H
#define NEPH_TRUTH_GUESS_H

#include "truth/lit_flight.h"
#include "truth/tracking.h"

/* Number of densities per cell. */
#define NEPH_GUESS_PLACES 6
#define NEPH_GUESS_STRETCHES (NEPH_LIT_CELLS * NEPH_GUESS_PLACES)

struct neph_guess {
    struct neph_ray ray;
    struct neph_lit_flight lit;             /* from guessed depths; valid if `lit.is_known` */
    double t0_m, stretch_m;                 /* start of the first segment; length of each */
    double depth[NEPH_GUESS_STRETCHES + 1]; /* guessed depth from the camera to each segment */
    double sun_depth[NEPH_LIT_CELLS + 1];   /* guessed depth from the cells' edges to the sun */
};

/* Optical depth of all media up to a distance, which may be +inf; from a few densities if a medium
 * has no closed form. */
struct neph_rgb neph_guess_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double length_m);

/* Make the guess for single scattering under a sun, if media are bounded on the ray and free
 * flights would miss the light: if the mean square of their estimates exceeds four times the
 * squared mean. Otherwise free flights are better than a guess. */
void neph_guess_init(struct neph_guess *guess, const struct neph_scene *scene,
                     const struct neph_ray *ray);

struct neph_guess_result {
    struct neph_collision collision; /* medium -1: zero density at the point */
    double value[3]; /* extinction of the medium per channel, divided by the probability density */
    double view_depth, sun_depth; /* guessed, from the camera and to the sun */
};

struct neph_guess_result neph_guess_sample(const struct neph_guess *guess,
                                           const struct neph_scene *scene,
                                           struct neph_random *random);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Where sunlight is scattered once on a ray through media without closed forms: the distribution of
 * truth/lit_flight.h from a guess of the optical depths, made of a few densities. The guess only
 * says where to look: densities at the places are exact, transmittances are estimated without bias.
 */
#ifndef NEPH_TRUTH_GUESS_H
#define NEPH_TRUTH_GUESS_H

#include "truth/lit_flight.h"
#include "truth/tracking.h"

/* Densities are looked up at so many places of each cell. */
#define NEPH_GUESS_PLACES 6
#define NEPH_GUESS_STRETCHES (NEPH_LIT_CELLS * NEPH_GUESS_PLACES)

struct neph_guess {
    struct neph_ray ray;
    struct neph_lit_flight lit;             /* by guessed depths; to be used when `lit.is_known` */
    double t0_m, stretch_m;                 /* where the first stretch begins; length of each */
    double depth[NEPH_GUESS_STRETCHES + 1]; /* guessed, from the camera to each stretch */
    double sun_depth[NEPH_LIT_CELLS + 1];   /* from the edges of the cells */
};

/* Optical depth of all media up to a distance, which may be +inf, from a few densities where a
 * medium has no closed form. */
struct neph_rgb neph_guess_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                 struct neph_vec3 direction, double length_m);

/* For single scattering under a sun, of a ray on which media have finite ends, where free flights
 * would miss the light: where their estimates would have more than four times the square of the
 * mean. Elsewhere they know the density better than a guess. */
void neph_guess_init(struct neph_guess *guess, const struct neph_scene *scene,
                     const struct neph_ray *ray);

struct neph_guessed {
    struct neph_collision collision; /* medium -1: there is no density at the place */
    double value[3]; /* extinction by the medium per channel, over the probability density */
    double view_depth, sun_depth; /* guessed, from the camera and to the sun */
};

struct neph_guessed neph_guess_draw(const struct neph_guess *guess, const struct neph_scene *scene,
                                    struct neph_random *random);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The first flight of all paths of a pixel if the media differ in brightness (scenes/sources.h). A
 * dark medium with nearly all collisions would hide a bright one from any number of samples; the
 * estimate would be 0 with variance 0. So each medium has its own share of the samples, and its own
 * table of its light:
 *
 *   L = sum over the media m of integral k_m T_m (T_others J_m) dt,
 *
 * k_m is the extinction, T_m the transmittance of medium m alone, J_m the light that it sends. The
 * medium is chosen first: half of the samples equally, the other half by the light of the tables.
 * The point is sampled in optical depths s of the chosen medium only (truth/lit_flight.h): by the
 * table, which includes the attenuation by all media; by free flight in this medium only, so that
 * no sample weighs more than the number of media times a small constant; and uniformly. The
 * outcomes of different media are distinct, so the estimate is unbiased for any choice.
 *
 * If a medium has no closed form, its optical depths are guessed from a few densities, and the
 * caller estimates the transmittance up to the point, as in truth/guess.h.
 */
#ifndef NEPH_TRUTH_MAJORANT_FLIGHT_H
#define NEPH_TRUTH_MAJORANT_FLIGHT_H

#include "scenes/sources.h"
#include "truth/guess.h"
#include "truth/lit_flight.h"

struct neph_medium_flight_part {
    int medium;
    double chance;                          /* probability of being chosen */
    double t0_m, t1_m;                      /* range of the ray in the medium; t1 may be +inf */
    struct neph_lit_flight lit;             /* in s, mean of the channels */
    double edge_t_m[NEPH_LIT_CELLS + 1];    /* distances of the edges of `lit` */
    double view_depth[NEPH_LIT_CELLS + 1];  /* at the edges: of all media, mean of the channels, */
    double sun_depth[NEPH_LIT_CELLS + 1];   /* to the camera and to the sun; may be guessed */
    double depth[NEPH_GUESS_STRETCHES + 1]; /* guessed s at equal distances; only without a closed
                                             * form */
};

struct neph_medium_flight {
    const struct neph_scene *scene;
    struct neph_ray ray;
    bool is_known;
    bool is_exact; /* all media have closed forms */
    int count;
    struct neph_medium_flight_part parts[NEPH_SCENE_MEDIA_MAX]; /* of the media that send light */
};

/* Set up. `is_known` is false if the media do not differ; and, if a medium has no closed form, also
 * if it is unbounded on the ray or if free flights collide with bright media often enough. */
void neph_medium_flight_init(struct neph_medium_flight *flight, const struct neph_scene *scene,
                             const struct neph_ray *ray);

/* Sample a collision, if `is_known`. `value` is its weight per channel over its probability
 * density: extinction of the medium, times the transmittance from the camera if `is_exact`. Medium
 * -1: no light. */
struct neph_guess_result neph_medium_flight_sample(const struct neph_medium_flight *flight,
                                                   struct neph_random *random);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The first flight of all paths of a pixel where the media differ in brightness
 * (scenes/sources.h): a dark medium that takes nearly all collisions would hide a bright one from
 * any number of samples, and the estimate would be 0 with variance 0. So each medium has its own
 * share of the samples, and its own table of where its light comes from:
 *
 *   L = sum over the media m of integral k_m T_m (T_others J_m) dt,
 *
 * k_m the extinction, T_m the transmittance of medium m by itself, J_m the light that it sends. The
 * medium is chosen first: half of the samples evenly, the rest by the light of the tables. The
 * place is drawn in optical depths s of the chosen medium by itself (truth/lit_flight.h): by the
 * table, which has the attenuation by all media, by free flight as if the medium were alone, so
 * that no sample weighs more than the number of media times a small constant, and evenly. The
 * outcomes of two media are different ones, so the estimate is free of bias whatever the choice is.
 *
 * Where a medium has no closed form, its optical depths are guessed from a few densities, and the
 * transmittance up to the place is the caller's to estimate, as in truth/guess.h.
 */
#ifndef NEPH_TRUTH_OWN_FLIGHT_H
#define NEPH_TRUTH_OWN_FLIGHT_H

#include "scenes/sources.h"
#include "truth/guess.h"
#include "truth/lit_flight.h"

struct neph_own_part {
    int medium;
    double chance;                          /* that it is chosen */
    double t0_m, t1_m;                      /* where the ray is in it; t1 may be +inf */
    struct neph_lit_flight lit;             /* in s, mean of the channels */
    double edge_t_m[NEPH_LIT_CELLS + 1];    /* where the edges of `lit` lie */
    double view_depth[NEPH_LIT_CELLS + 1];  /* at the edges: of all media, mean of the channels, */
    double sun_depth[NEPH_LIT_CELLS + 1];   /* to the camera and to the sun; may be guessed */
    double depth[NEPH_GUESS_STRETCHES + 1]; /* guessed s at even distances; without closed form */
};

struct neph_own_flight {
    const struct neph_scene *scene;
    struct neph_ray ray;
    bool is_known;
    bool is_exact; /* all media have closed forms */
    int count;
    struct neph_own_part parts[NEPH_SCENE_MEDIA_MAX]; /* of the media that send light */
};

/* `is_known` is false when the media do not differ, and where a medium has no closed form also when
 * it has no end on the ray, or when free flights meet bright media often enough. */
void neph_own_flight_init(struct neph_own_flight *flight, const struct neph_scene *scene,
                          const struct neph_ray *ray);

/* Draw a collision, when `is_known`. `value` is its weight per channel over its probability
 * density: extinction by the medium, times the transmittance from the camera when `is_exact`.
 * Medium -1: nothing would come. */
struct neph_guessed neph_own_flight_draw(const struct neph_own_flight *flight,
                                         struct neph_random *random);

#endif

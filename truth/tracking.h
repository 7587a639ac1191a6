/* SPDX-License-Identifier: MIT
 *
 * Free flights through the media of a scene: where light collides next, and how much arrives.
 *
 * Each medium is a Poisson process of its own along the ray, and the nearest of all their
 * collisions counts. Fog is inverted in closed form; in the other media candidates of a majorant
 * are accepted with the probability extinction / majorant (E. R. Woodcock et al. 1965), the
 * majorant being constant over the cells of a grid (scenes/majorant.h) or, in a shell, over a scale
 * height. Colour: one channel decides, and what the same outcome would have been worth in the other
 * channels is told (B. Miller, I. Georgiev, W. Jarosz, "A Null-Scattering Path Integral Formulation
 * of Light Transport", SIGGRAPH 2019, section 6.1).
 */
#ifndef NEPH_TRUTH_TRACKING_H
#define NEPH_TRUTH_TRACKING_H

#include "scenes/scene.h"
#include "truth/random.h"

#include <stdint.h>

struct neph_tracker;

/* Majorants for a scene, which must outlive the tracker. Shared by threads: nothing changes after.
 * NEPH_ERR_UNSUPPORTED: a medium without the bounds that majorants need. */
enum neph_status neph_tracker_create(const struct neph_scene *scene, struct neph_tracker **tracker,
                                     struct neph_diag *diag);

/* NULL is fine. */
void neph_tracker_destroy(struct neph_tracker *tracker);

/* Every medium attenuates all channels alike. */
bool neph_tracker_is_grey(const struct neph_tracker *tracker);

/* Work done, for the record. */
struct neph_tracking_cost {
    uint64_t collisions, lookups;
};

struct neph_ray {
    struct neph_vec3 origin_m, direction; /* the direction is unit */
    double end_m;                         /* may be +inf */
};

struct neph_collision {
    double t_m; /* the end of the ray when there is none */
    int medium; /* of the scene; -1: none before the end */
    /* The probability (density) of this outcome in each channel, divided by that in the channel
     * that decided. */
    double ratio[3];
};

/* Sample the next collision as light of one channel (0..2) meets it. */
struct neph_collision neph_tracker_collide(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, int channel,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost);

/* An unbiased estimate of the transmittance of the whole ray, per channel: exact where the media
 * have closed forms (and then no random number is used), else by ratio tracking (J. Novak, A.
 * Selle, W. Jarosz, "Residual Ratio Tracking for Estimating Attenuation in Participating Media",
 * SIGGRAPH Asia 2014). `expected_depth` is about the ray's optical depth where even a faint
 * estimate must be a good one: the majorants are raised by it (16-fold at most), for with a tight
 * majorant the relative variance is e^(optical depth). 0: a faint one may be all or nothing. */
struct neph_rgb neph_tracker_transmittance(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, double expected_depth,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost);

#endif

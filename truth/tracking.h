/* SPDX-License-Identifier: MIT
 *
 * Free flights through the media of a scene: the next collision, and transmittance.
 *
 * Each medium is an independent Poisson process along the ray, and the nearest of all collisions
 * counts. Fog is inverted in closed form. In other media, candidates of a majorant are accepted
 * with the probability extinction / majorant (E. R. Woodcock et al. 1965); the majorant is constant
 * over the cells of a grid (scenes/majorant.h) or, in a shell, over a scale height. Colour: one
 * channel decides, and the relative probability of the same outcome in the other channels is
 * returned (B. Miller, I. Georgiev, W. Jarosz, "A Null-Scattering Path Integral Formulation of
 * Light Transport", SIGGRAPH 2019, section 6.1).
 */
#ifndef NEPH_TRUTH_TRACKING_H
#define NEPH_TRUTH_TRACKING_H

#include "scenes/scene.h"
#include "truth/random.h"

#include <stdint.h>

struct neph_tracker;

/* Create the majorants for a scene, which must outlive the tracker. Threads may share it: it is
 * constant afterwards. NEPH_ERR_UNSUPPORTED: a medium without the bounds that majorants need. */
enum neph_status neph_tracker_create(const struct neph_scene *scene, struct neph_tracker **tracker,
                                     struct neph_diag *diag);

/* `tracker` may be NULL. */
void neph_tracker_destroy(struct neph_tracker *tracker);

/* Whether every medium attenuates all channels equally. */
bool neph_tracker_is_grey(const struct neph_tracker *tracker);

/* Statistics of the work done. */
struct neph_tracking_cost {
    uint64_t collisions, lookups;
};

struct neph_ray {
    struct neph_vec3 origin_m, direction; /* the direction is unit */
    double end_m;                         /* may be +inf */
};

struct neph_collision {
    double t_m; /* the end of the ray if there is no collision */
    int medium; /* index in the scene; -1: none before the end */
    /* The probability (density) of this outcome in each channel, relative to the deciding
     * channel. */
    double ratio[3];
};

/* Sample the next collision for light of one channel (0..2). */
struct neph_collision neph_tracker_collide(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, int channel,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost);

/* An unbiased estimate of the transmittance of the whole ray, per channel. It is exact, without
 * random numbers, if the media have closed forms; else by ratio tracking (J. Novak, A. Selle, W.
 * Jarosz, "Residual Ratio Tracking for Estimating Attenuation in Participating Media", SIGGRAPH
 * Asia 2014). `expected_depth`: approximate optical depth of the ray, if even a faint estimate must
 * have low noise. It raises the majorants (at most 16-fold), because with a tight majorant the
 * relative variance is e^(optical depth). 0: a faint estimate may be all or nothing. */
struct neph_rgb neph_tracker_transmittance(const struct neph_tracker *tracker,
                                           const struct neph_ray *ray, double expected_depth,
                                           struct neph_random *random,
                                           struct neph_tracking_cost *cost);

#endif

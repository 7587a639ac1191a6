/* SPDX-License-Identifier: MIT
 *
 * The oracle: an unbiased path tracer for participating media in double precision on the CPU. No
 * clamp, no limit on bounces, Russian roulette only at low throughput. It is the reference of every
 * scene without a closed form, and is tested against closed forms (truth/transport.h,
 * truth/slab.h).
 *
 * Estimator. For each pixel, the unscattered light (background or surface behind the media) is
 * exact, by closed-form transmittance; in-scattered light is sampled. The first collision is
 * sampled from the exact distribution along the pixel's ray (truth/flight.h). Later collisions are
 * sampled per medium, by delta tracking with its majorants (E. R. Woodcock et al. 1965) or by
 * inverting the closed form (fog); the nearest collision of all media counts (superposition of
 * Poisson processes). At each collision the sun is sampled with exact transmittance, or, if a
 * medium has no closed form (Horizon), by ratio tracking (J. Novak et al. 2014). Colour: one path
 * serves all channels. One channel is chosen for tracking, and the probabilities of the path in
 * every channel are carried along (spectral MIS of B. Miller, I. Georgiev, W. Jarosz, "A
 * null-scattering path integral formulation of light transport", SIGGRAPH 2019).
 *
 * A narrow peak of a phase function is met by few paths. Where a medium has another phase function
 * than isotropic, Rayleigh or Henyey-Greenstein, a part of the directions is drawn around the sun,
 * with the mixture's weight (directional importance sampling: R. Buras, B. Mayer, JQSRT 112, 2011):
 * by the medium's own phase function, at surfaces and in other media by that of the first such
 * medium. The part is T / (1 + sum of T): T is the sampled transmittance of the sunlight at this
 * event, 0.5 at the visible surface; the sum is over the events so far.
 *
 * With single scattering, the first collision is sampled by its sunlight (truth/lit_flight.h; if a
 * medium has no closed form, by a guess of it, truth/guess.h), because against the light, free
 * flights end far from the bright part.
 *
 * The scene's scattering: `none` and `single` have one event, at the visible surface or (in
 * `single`) in a medium; sunlight, and with environment light the background, reach it unscattered.
 * `multiple` has all events. Emission of media (scenes/emission.h) is added at every collision, so
 * in `none` and `single` it is visible but lights nothing.
 *
 * Samples are independent, so the variance of a pixel is unbiased: the sum of squared deviations
 * over n (n - 1).
 */
#ifndef NEPH_TRUTH_ORACLE_H
#define NEPH_TRUTH_ORACLE_H

#include "base/doubt.h"
#include "scenes/scene.h"

#include <stdint.h>

struct neph_oracle_params {
    int width_px, height_px;
    double frame;
    uint64_t seed;
    int samples;         /* paths per pixel, >= 2; the maximum if there is a target */
    double target_error; /* stop when the rms over pixels of the standard error of the mean, divided
                          * by the rms radiance of volume light, is below this; 0: all samples */
    double time_limit_s; /* stop in time, with the samples so far; +inf: no limit */
    const char *checkpoint; /* file to resume from, if it exists, and to leave the sums in; NULL:
                             * none. If it has more samples than requested, all are used. */
};

struct neph_oracle_stats {
    int samples;             /* samples of every pixel */
    double error;            /* the reached error, as target_error */
    struct neph_doubt doubt; /* whether the variances are to be trusted; of the mean over the
                              * channels */
    double wall_s;
    uint64_t collisions, lookups;
};

/* False, with the reason as text, for unsupported scenes: metal; and multiple scattering without
 * absorption in an unbounded fog, where paths have an infinite mean length. */
bool neph_oracle_can_render(const struct neph_scene *scene, char *reason, size_t reason_size);

/* Render R G B, volume.*, order1.* (light of the sun or the environment, scattered exactly once by
 * a medium before any surface), transmittance.*, Z, variance.* (of the mean of R G B: its squared
 * standard error), with the names of base/image.h. The same params and scene give the same bits, on
 * any number of threads, with or without interruptions at a checkpoint (except with a time limit).
 * `*frame` is owned by the caller; `stats` may be NULL. NEPH_ERR_USAGE: a parameter is out of
 * range. NEPH_ERR_UNSUPPORTED: see neph_oracle_can_render(). NEPH_ERR_INPUT: the checkpoint is
 * damaged or of another render. NEPH_ERR_INTERRUPTED: a checkpoint, if requested, contains all
 * finished work. */
enum neph_status neph_oracle_render(const struct neph_scene *scene,
                                    const struct neph_oracle_params *params,
                                    struct neph_image **frame, struct neph_oracle_stats *stats,
                                    struct neph_diag *diag);

#endif

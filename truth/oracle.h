/* SPDX-License-Identifier: MIT
 *
 * The oracle: an unbiased path tracer of participating media in double precision on the CPU. No
 * clamp, no limit on bounces, roulette only at low throughput. It is the reference of every scene
 * without a closed form, and is tested against closed forms (truth/transport.h, truth/slab.h).
 *
 * Estimator. Per pixel: the unscattered light (background or surface seen through the media) is
 * exact, by closed-form transmittance; in-scattered light is sampled. The first collision is drawn
 * from the exact distribution along the pixel's ray (truth/flight.h), later ones per medium, by
 * delta tracking through its majorants (E. R. Woodcock et al. 1965) or by inverting the closed form
 * (fog); the nearest collision of all media counts (superposition of Poisson processes). At each
 * collision the sun is sampled with exact transmittance; where a medium has no closed form
 * (Horizon), by ratio tracking (J. Novak et al. 2014). Colour: one path serves all channels; a
 * channel is chosen for tracking and the probabilities of the path in every channel are carried
 * along (spectral MIS of B. Miller, I. Georgiev, W. Jarosz, "A null-scattering path integral
 * formulation of light transport", SIGGRAPH 2019).
 *
 * Where light is scattered once, the first collision is drawn by the sunlight that comes from there
 * (truth/lit_flight.h; where a medium has no closed form by a guess at it, truth/guess.h), for
 * against the light free flights end far from where it is.
 *
 * The scene's switches: `none` and `single` know one event, the surface in view or (in `single`) a
 * medium; the sun, and with environment light the background, reach it unscattered. `multiple`
 * knows all. Emission of media (scenes/emission.h) is added at every collision, so that in `none`
 * and `single` it is seen and lights nothing.
 *
 * Samples are independent, so that the variance of a pixel is unbiased: the sum of squared
 * deviations over n (n - 1).
 */
#ifndef NEPH_TRUTH_ORACLE_H
#define NEPH_TRUTH_ORACLE_H

#include "base/image.h"
#include "scenes/scene.h"

#include <stdint.h>

struct neph_oracle_params {
    int width_px, height_px;
    double frame;
    uint64_t seed;
    int samples;         /* paths per pixel, >= 2; the most when there is a target */
    double target_error; /* stop when the rms over pixels of the standard error of the mean divided
                            by the rms radiance of volume light is below this; 0: all samples */
    double time_limit_s; /* stop in time, with the samples done; +inf: none */
    const char *checkpoint; /* file to resume from, when it is there, and to leave the sums in;
                               NULL: none. More samples than asked for are all used. */
};

struct neph_oracle_stats {
    int samples;  /* taken of every pixel */
    double error; /* as target_error, reached */
    double wall_s;
    uint64_t collisions, lookups;
};

/* False, with the reason in words, for scenes that the estimator cannot do: metal, and all orders
 * of scattering without absorption in a fog that has no end, where paths have an infinite mean
 * length. */
bool neph_oracle_can_render(const struct neph_scene *scene, char *reason, size_t reason_size);

/* Render: R G B, volume.*, order1.* (light of the sun or the surroundings scattered exactly once by
 * a medium, before any surface), transmittance.*, Z, variance.* (of the mean of R G B: the square
 * of its standard error), in base/image.h's names. Same params and scene: same bits, on any number
 * of threads, with or without rests at a checkpoint (a time limit apart). `*frame` is the caller's;
 * `stats` may be NULL. NEPH_ERR_USAGE: a parameter is out of range. NEPH_ERR_UNSUPPORTED:
 * neph_oracle_can_render() says no. NEPH_ERR_INPUT: the checkpoint is damaged or of another render.
 * NEPH_ERR_INTERRUPTED: leaves the checkpoint, if there is one, with all that was done. */
enum neph_status neph_oracle_render(const struct neph_scene *scene,
                                    const struct neph_oracle_params *params,
                                    struct neph_image **frame, struct neph_oracle_stats *stats,
                                    struct neph_diag *diag);

#endif

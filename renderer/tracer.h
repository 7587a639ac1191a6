/* SPDX-License-Identifier: MIT
 *
 * The path tracer on the device: the estimator of truth/oracle.h in float32, without bias, for
 * lavapipe and GPUs. No clamp and no limit on bounces; Russian roulette only below a twentieth of
 * the initial throughput. Every float32 sum carries its rounding error.
 *
 * Estimator:
 *
 * - Unscattered radiance is exact. Every sample collides on the view ray, at a point drawn by the
 *   inverse of its optical depth (forced collision). Scenes with a medium without a closed-form
 *   optical depth (Horizon) have neither: the view ray is tracked like any other.
 * - Later free paths: by inversion of the closed form (homogeneous, fog), else by delta tracking
 *   with local majorants (E. R. Woodcock et al. 1965). The nearest collision of all media counts.
 * - At each event the sun is sampled. Its transmittance is in closed form (fog; at the first
 *   collision all media, but not voxel grids with multiple scattering), from a table, or by ratio
 *   tracking (J. Novak et al., "Residual Ratio Tracking", SIGGRAPH Asia 2014), with Russian
 *   roulette at low transmittance.
 * - The table is used for multiple scattering in grey clouds with a closed-form optical depth, if
 *   its nodes are dense enough to pay. Its error is estimated at one event of each batch of samples
 *   and subtracted, so it adds no bias (shaders/tracer_sun.glsl).
 * - One path serves all three channels, with the balance heuristic over the channels (B. Miller, I.
 *   Georgiev, W. Jarosz, "A Null-Scattering Path Integral Formulation of Light Transport", SIGGRAPH
 *   2019).
 * - Where a phase function reaches the device as a table, which may have a narrow peak, a part of
 *   the directions is drawn around the sun by that phase function (truth/oracle.h).
 * - With single scattering the first collision is sampled in proportion to the sunlight that
 *   arrives there (truth/lit_flight.h). With Horizon clouds, where free flights would miss it, in
 *   proportion to a guess of that light, and ratio tracking with raised majorants determines the
 *   actual light (truth/guess.h).
 *
 * Scattering settings of the scene: `none` and `single` have one event: sunlight and, if present,
 * environment light reach a surface (or, in `single`, a medium) unscattered. `multiple` has all
 * orders.
 *
 * Random numbers: pseudo-random, or (`sobol`) Owen-scrambled Sobol points for the first decisions
 * of a sample: position of the first collision, next direction, next distance
 * (shaders/low_discrepancy.glsl). Each pixel has two independently scrambled sequences, used by
 * samples in alternation.
 *
 * Variance: samples come in pairs with the same stratum and independent random numbers, so their
 * squared differences estimate the variance of the mean, stratified or not (W. G. Cochran,
 * "Sampling Techniques", 5A.12). Degrees of freedom: half the number of samples. With `sobol` the
 * variance within a sequence is no estimate. The squared difference of the two sequences' means is
 * one, with one degree of freedom: right on average over pixels, but of little use for one pixel.
 */
#ifndef NEPH_RENDERER_TRACER_H
#define NEPH_RENDERER_TRACER_H

#include "base/doubt.h"
#include "renderer/shaders/constants.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

#define NEPH_TRACER_SIDE_MAX_PX 4096
#define NEPH_TRACER_BATCH_SAMPLES (2 * NEPH_GPU_STRATA)
#define NEPH_TRACER_SAMPLES_MAX (1 << 28)
#define NEPH_TRACER_SUN_NODES 500000      /* 80 along each side of a cube */
#define NEPH_TRACER_SUN_NODES_MAX 4000000 /* limit of a dispatch */

struct neph_tracer_params {
    int width_px, height_px; /* 1..NEPH_TRACER_SIDE_MAX_PX */
    double frame;            /* of the scene; may be fractional */
    /* Six numbers a pixel, row by row: origin [m] and unit direction of a ray in place of the
     * camera's, which is orthographic; its position is the origin of the coordinates in float32. Z
     * has no meaning then. NULL: the camera's rays. */
    const double *rays;
    uint64_t seed;
    bool sobol;          /* low-discrepancy numbers for the first decisions of each sample */
    int sun_nodes;       /* of the sunlight table, at most; 0: a sun ray at each event. No effect on
                            scenes without the table (above). */
    int samples;         /* per pixel, >= 2, rounded up to whole batches; the maximum with a target
                          */
    double target_error; /* as in truth/oracle.h: stop when the rms over pixels of the standard
                            error of the mean, divided by the rms radiance of volume light, is below
                            this; 0: all samples */
    double time_limit_s; /* stop at the end of a batch when another would exceed it (at least one is
                            taken); +inf: no limit */
    const char *checkpoint;  /* file to resume from and to save the sums to; NULL: none */
    uint32_t dispatch_turns; /* loop iterations of a dispatch, at most; 0: automatic. Does not
                                change results. */
    uint32_t part_pixels; /* pixels in one buffer, at most; 0: the device's limit. Does not change
                             results. */
};

struct neph_tracer_stats {
    int samples;             /* samples of every pixel */
    double error;            /* reached value of target_error's measure */
    struct neph_doubt doubt; /* whether the variances are to be trusted; of the channels' sum */
    double gpu_s;            /* device time of all dispatches; NaN when the device has no clock */
    double wall_s;
    uint64_t collisions;   /* real ones */
    uint64_t lookups;      /* densities evaluated at points of paths */
    uint64_t closed_forms; /* optical depths of one medium in closed form */
    int dispatches;
};

/* False, with the reason as text, for features that this estimator does not support, and for media
 * outside the float32 range (renderer/float32_range.h). */
bool neph_tracer_can_render(const struct neph_scene *scene, char *reason, size_t reason_size);

/* Render a frame: R G B, volume.*, order1.* (scattered exactly once, by a medium), transmittance.*,
 * variance.* (of the mean of R G B: the square of its standard error), Z. Same scene, params and
 * device: same bits, with or without an interruption at a checkpoint. The caller owns `*frame`;
 * `stats` may be NULL. NEPH_ERR_USAGE: a parameter is out of range. NEPH_ERR_UNSUPPORTED:
 * neph_tracer_can_render() is false. NEPH_ERR_INPUT: the checkpoint is damaged or of another
 * render. NEPH_ERR_INTERRUPTED: within about a second; saves the checkpoint, if one is set. */
enum neph_status neph_tracer_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                    const struct neph_tracer_params *params,
                                    struct neph_image **frame, struct neph_tracer_stats *stats,
                                    struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The path tracer on the device: the estimator of truth/oracle.h in float32, without bias, for
 * lavapipe and GPUs alike. No clamp, no limit on bounces, roulette only below a twentieth of the
 * first throughput; every float32 sum carries its rounding error.
 *
 * Estimator. What reaches the camera unscattered is exact, and every sample collides on the view
 * ray, where the inverse of its optical depth says (forced collision). A scene with a medium of
 * unknown optical depth (Horizon) has neither: there the view ray is tracked like any other. Later
 * free paths: by inversion of the closed form (homogeneous, fog), by delta tracking through local
 * majorants elsewhere (E. R. Woodcock et al. 1965); the nearest of all media's collisions counts.
 * At each event the sun is sampled, its transmittance in closed form (fog; all media at the first
 * collision, but not voxel grids where light goes on), by a table, or by ratio tracking (J. Novak
 * et al., "Residual Ratio Tracking", SIGGRAPH Asia 2014), with roulette where little of it would
 * arrive. The table is there for light of all orders in clouds without colour whose optical depth
 * has a closed form, if its nodes are near enough for it to pay; what it is wrong by at one event
 * of a batch of samples stands for all, without bias (shaders/tracer_sun.glsl).
 * One path serves all three channels, with the balance heuristic over the channels (B. Miller, I.
 * Georgiev, W. Jarosz, "A Null-Scattering Path Integral Formulation of Light Transport", SIGGRAPH
 * 2019).
 *
 * Where light is scattered once, the first collision is drawn by the sunlight that comes from there
 * (truth/lit_flight.h); in a scene with Horizon clouds, where free flights would miss it, by a
 * guess of that light, and ratio tracking with raised majorants tells what arrives (truth/guess.h).
 *
 * What the scene's switches mean: `none` and `single` know one event: sunlight and, where there is
 * environment light, the background reach a surface (or, in `single`, a medium) without having been
 * scattered before. `multiple` knows all.
 *
 * Numbers are random, or for the first decisions of a sample (where it collides first, where to
 * from there, and how far) those of Sobol's sequence with Owen's scrambling (`sobol`;
 * shaders/low_discrepancy.glsl): two sequences a pixel, each scrambled by itself, that samples are
 * taken from by turns.
 *
 * Variance. Samples come in pairs; the two of a pair lie in the same stratum and differ by chance
 * alone, so their squared differences estimate the variance of the mean, stratified or not
 * (W. G. Cochran, "Sampling Techniques", 5A.12). Degrees of freedom: half the number of samples.
 * With `sobol` the variance within a sequence says nothing; the squared difference of the two
 * sequences' means is what estimates it, with one degree of freedom: right on average over pixels,
 * and of one pixel little is known.
 */
#ifndef NEPH_RENDERER_TRACER_H
#define NEPH_RENDERER_TRACER_H

#include "base/image.h"
#include "renderer/shaders/constants.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

#define NEPH_TRACER_SIDE_MAX_PX 4096
#define NEPH_TRACER_BATCH_SAMPLES (2 * NEPH_GPU_STRATA)
#define NEPH_TRACER_SAMPLES_MAX (1 << 28)
#define NEPH_TRACER_SUN_NODES 500000      /* 80 along each side of a cube */
#define NEPH_TRACER_SUN_NODES_MAX 4000000 /* a dispatch has no room for more */

struct neph_tracer_params {
    int width_px, height_px; /* 1..NEPH_TRACER_SIDE_MAX_PX */
    double frame;            /* of the scene; may be fractional */
    uint64_t seed;
    bool sobol;          /* low-discrepancy numbers for the first decisions of each sample */
    int sun_nodes;       /* of the table of sunlight, at most; 0: a ray to the sun from each event.
                            Where there is no table (above) it changes nothing. */
    int samples;         /* per pixel, >= 2, rounded up to whole batches; the most with a target */
    double target_error; /* as in truth/oracle.h: stop when the rms over pixels of the standard
                            error of the mean divided by the rms radiance of volume light is below
                            this; 0: all samples */
    double time_limit_s; /* stop at the end of a batch when there is no time for another (there is
                            always one); +inf: none */
    const char *checkpoint;  /* file to resume from and to leave the sums in; NULL: none */
    uint32_t dispatch_turns; /* most turns of a dispatch; 0: chosen here. Changes no bit. */
    uint32_t part_pixels; /* of the frame in one buffer, at most; 0: as the device allows. Changes
                                no bit. */
};

struct neph_tracer_stats {
    int samples;  /* taken of every pixel */
    double error; /* as target_error, reached */
    double gpu_s; /* device time of all dispatches; NaN when the device has no clock */
    double wall_s;
    uint64_t collisions;   /* real ones */
    uint64_t lookups;      /* densities looked up at a point, by paths */
    uint64_t closed_forms; /* optical depths of one medium in closed form */
    int dispatches;
};

/* False, with the reason in words, for what this estimator cannot do, or where a medium
 * lies beyond the reach of float32 (renderer/reach.h). */
bool neph_tracer_can_render(const struct neph_scene *scene, char *reason, size_t reason_size);

/* Render a frame: R G B, volume.*, order1.* (scattered exactly once, by a medium), transmittance.*,
 * variance.* (of the mean of R G B: the square of its standard error), Z. Same scene, params and
 * device: same bits, with or without a rest at a checkpoint. `*frame` is the caller's; `stats` may
 * be NULL. NEPH_ERR_USAGE: a parameter is out of range. NEPH_ERR_UNSUPPORTED:
 * neph_tracer_can_render() says no. NEPH_ERR_INPUT: the checkpoint is damaged or of another render.
 * NEPH_ERR_INTERRUPTED: within about a second; leaves the checkpoint, if there is one. */
enum neph_status neph_tracer_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                    const struct neph_tracer_params *params,
                                    struct neph_image **frame, struct neph_tracer_stats *stats,
                                    struct neph_diag *diag);

#endif

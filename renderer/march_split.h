/* SPDX-License-Identifier: MIT
 *
 * Splitting of a march of many rays into dispatches. A thread may not exceed the driver's limit of
 * loop iterations (compute.h), and a dispatch must be short enough for Ctrl-C to take effect. For
 * renderers that include shaders/march.glsl.
 */
#ifndef NEPH_RENDERER_MARCH_SPLIT_H
#define NEPH_RENDERER_MARCH_SPLIT_H

#include "renderer/gpu_scene.h"
#include "renderer/march_params.h"
#include "renderer/pace.h"

enum {
    NEPH_MARCH_LOCAL_SIZE = 64, /* of shaders/march.glsl */
    NEPH_MARCH_STATE_BYTES = sizeof(
        struct neph_gpu_march_state), /* one state for each ray of a dispatch */
    /* The scene's buffers, the states of the rays, the results, the sun cache, traced light, the
     * sky. */
    NEPH_MARCH_BUFFERS = NEPH_GPU_SCENE_BUFFERS + 6,
    NEPH_MARCH_CONSTANTS = NEPH_GPU_SCENE_CONSTANTS + 4,
};

struct neph_march_split {
    uint64_t ray_count, step_count; /* of the whole march */
    uint64_t rays_max;              /* upper limit in any dispatch: the capacity of its buffers */
    uint64_t rays, steps;           /* current limits of one dispatch */
    uint64_t iterations_per_step,
        iterations_per_dispatch; /* loop iterations of one ray, upper bounds */
    uint64_t iterations_least;   /* of all rays in a dispatch, at least */
    struct neph_pace pace;       /* in loop iterations */
};

/* Whether the sky lights media. Only paths can sample it in all directions. */
bool neph_march_has_sky_light(const struct neph_march_params *params);

/* Whether sun rays are marched at all. */
bool neph_march_has_sun_rays(const struct neph_scene *scene,
                             const struct neph_march_params *params);

/* Steps of the scene's sun rays: 0 if none is marched. */
int neph_march_sun_steps(const struct neph_scene *scene, const struct neph_march_params *params);

/* Write the march's settings into the frame for the shaders. */
void neph_march_set_frame(const struct neph_scene *scene, const struct neph_march_params *params,
                          struct neph_gpu_frame *frame);

/* Specialization constants of the shaders. */
void neph_march_constants(const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                          uint32_t constants[NEPH_MARCH_CONSTANTS]);

/* The number of events that one thread may have in a dispatch. Each has a sun ray and a ray to the
 * next solid, beside `turns` loop iterations that evaluate each medium twice. NEPH_ERR_UNSUPPORTED:
 * 0. */
enum neph_status neph_march_split_events(const struct neph_vulkan *vulkan,
                                         const struct neph_scene *scene,
                                         const struct neph_gpu_scene *gpu,
                                         const struct neph_march_params *params, uint64_t turns,
                                         uint64_t *events, struct neph_diag *diag);

/* NEPH_ERR_UNSUPPORTED: a single step exceeds the limits of a dispatch. */
enum neph_status neph_march_split_make(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, uint64_t ray_count,
                                       struct neph_march_split *cut, struct neph_diag *diag);

/* For rays that are not split: each has `samples` evaluations of the media and `sun_rays` sun rays.
 * Errors as of _make. */
enum neph_status neph_march_split_make_whole(
    const struct neph_vulkan *vulkan, const struct neph_scene *scene,
    const struct neph_gpu_scene *gpu, const struct neph_march_params *params, uint64_t samples,
    uint64_t sun_rays, uint64_t ray_count, struct neph_march_split *cut, struct neph_diag *diag);

/* Adapt the size of further dispatches to the measured time of all dispatches of a march. Results
 * do not depend on it. */
void neph_march_split_adapt(struct neph_march_split *cut, double gpu_s);

/* Whether the march is one dispatch. */
bool neph_march_split_is_whole(const struct neph_march_split *cut);

/* Run one dispatch. The last dispatch of a ray ends with end_step = step_count. */
typedef enum neph_status neph_march_body(const struct neph_gpu_march_run *run, void *context,
                                         struct neph_diag *diag);

/* Run all dispatches in order until the first error. NEPH_ERR_INTERRUPTED: neph_interrupted()
 * between two dispatches. */
enum neph_status neph_march_split_run(const struct neph_march_split *cut, neph_march_body *body,
                                      void *context, struct neph_diag *diag);

#endif

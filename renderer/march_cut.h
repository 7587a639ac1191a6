/* SPDX-License-Identifier: MIT
 *
 * How a march of many rays is cut into dispatches: no thread may turn more loops than a driver
 * allows (compute.h), and none may hold the device so long that Ctrl-C is not heard. For the
 * renderers that include shaders/march.glsl.
 */
#ifndef NEPH_RENDERER_MARCH_CUT_H
#define NEPH_RENDERER_MARCH_CUT_H

#include "renderer/gpu_scene.h"
#include "renderer/march_params.h"
#include "renderer/pace.h"

enum {
    NEPH_MARCH_LOCAL_SIZE = 64, /* of shaders/march.glsl */
    NEPH_MARCH_STATE_BYTES = sizeof(
        struct neph_gpu_march_state), /* one for each ray of a dispatch */
    /* The scene's, a march's states, what it makes of them, the sun cache, traced light, the sky.
     */
    NEPH_MARCH_BUFFERS = NEPH_GPU_SCENE_BUFFERS + 6,
    NEPH_MARCH_CONSTANTS = NEPH_GPU_SCENE_CONSTANTS + 4,
};

struct neph_march_cut {
    uint64_t ray_count, step_count; /* of the whole */
    uint64_t rays_max;              /* ever in one dispatch: what its buffers have room for */
    uint64_t rays, steps;           /* now, at most, in one dispatch */
    uint64_t turns_per_step, turns_per_dispatch; /* of a ray, at most */
    uint64_t turns_least;                        /* of all rays in a dispatch */
    struct neph_pace pace;                       /* in such turns */
};

/* Whether the sky lights media: paths alone can ask for it in all directions. */
bool neph_march_sky_lights(const struct neph_march_params *params);

/* Whether sun rays are marched at all. */
bool neph_march_marches_sun(const struct neph_scene *scene, const struct neph_march_params *params);

/* Steps of the scene's sun rays: 0 where none is marched. */
int neph_march_sun_steps(const struct neph_scene *scene, const struct neph_march_params *params);

/* Write into a frame what the shaders are told there. */
void neph_march_set_frame(const struct neph_scene *scene, const struct neph_march_params *params,
                          struct neph_gpu_frame *frame);

/* Specialization constants of the shaders. */
void neph_march_constants(const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                          uint32_t constants[NEPH_MARCH_CONSTANTS]);

/* How many events one thread may have in a dispatch, each with a sun ray and a ray to the next
 * solid, beside so many turns that look at each medium twice. NEPH_ERR_UNSUPPORTED: none. */
enum neph_status neph_march_cut_events(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, uint64_t turns,
                                       uint64_t *events, struct neph_diag *diag);

/* NEPH_ERR_UNSUPPORTED: one step alone is more than a dispatch may hold. */
enum neph_status neph_march_cut_make(const struct neph_vulkan *vulkan,
                                     const struct neph_scene *scene,
                                     const struct neph_gpu_scene *gpu,
                                     const struct neph_march_params *params, uint64_t ray_count,
                                     struct neph_march_cut *cut, struct neph_diag *diag);

/* Rays that are not cut: each has some samples of the media, and some sun rays. Errors as of _make.
 */
enum neph_status neph_march_cut_make_whole(const struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_gpu_scene *gpu,
                                           const struct neph_march_params *params, uint64_t samples,
                                           uint64_t sun_rays, uint64_t ray_count,
                                           struct neph_march_cut *cut, struct neph_diag *diag);

/* The device took so long for all dispatches of a march: the next will be cut by that. What is
 * marched does not depend on it. */
void neph_march_cut_learn(struct neph_march_cut *cut, double gpu_s);

/* Whether it is one dispatch. */
bool neph_march_cut_is_whole(const struct neph_march_cut *cut);

/* Runs one dispatch. The last of its rays ends with end_step = step_count. */
typedef enum neph_status neph_march_body(const struct neph_gpu_march_run *run, void *context,
                                         struct neph_diag *diag);

/* All dispatches, in the order in which they must come; the first error ends it.
 * NEPH_ERR_INTERRUPTED: neph_interrupted() between two of them. */
enum neph_status neph_march_cut_run(const struct neph_march_cut *cut, neph_march_body *body,
                                    void *context, struct neph_diag *diag);

#endif

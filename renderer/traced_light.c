/* SPDX-License-Identifier: MIT */
#include "renderer/traced_light.h"

#include "base/interrupt.h"
#include "renderer/relative.h"

#include <string.h>

/* Does not compile with a new lighting: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");

static const uint32_t walk_code[] = {
#include "shaders/light_walk.comp.inc"
};
static const uint32_t settle_code[] = {
#include "shaders/light_settle.comp.inc"
};
static const uint32_t smooth_code[] = {
#include "shaders/light_smooth.comp.inc"
};

enum { local_size = 64 };

/* Loop iterations of a path in a round. A path through a thick cloud needs several times as many
 * and continues in the next round, so all rounds take equally long. */
static const uint32_t turns = 64;

/* --- buffers --------------------------------------------------------------------------------- */

static uint32_t count_texels_along(const struct neph_traced_light *light, int axis)
{
    const uint32_t texel_px = (uint32_t)light->params.light.texel_px;
    return (light->size_px[axis] + texel_px - 1) / texel_px;
}

static uint32_t texel_count(const struct neph_traced_light *light)
{
    return count_texels_along(light, 0) * count_texels_along(light, 1);
}

static uint32_t path_count(const struct neph_traced_light *light)
{
    return texel_count(light) * (uint32_t)light->params.light.paths;
}

static void destroy_sized(struct neph_traced_light *light)
{
    neph_buffer_destroy(light->vulkan, &light->smoothed);
    for (int i = 0; i < 2; i++)
        neph_buffer_destroy(light->vulkan, &light->texels[i]);
    neph_buffer_destroy(light->vulkan, &light->found);
    neph_buffer_destroy(light->vulkan, &light->paths);
}

static enum neph_status create_sized(struct neph_traced_light *light, struct neph_diag *diag)
{
    const size_t texels = texel_count(light), paths = path_count(light),
                 texel_bytes = sizeof(struct neph_gpu_light_texel);
    const struct neph_buffer_row rows[] = {
        {&light->paths, NEPH_BUFFER_DEVICE, paths * sizeof(struct neph_gpu_light_path),
         "light paths"},
        {&light->found, NEPH_BUFFER_DEVICE, paths * texel_bytes, "light found"},
        {&light->texels[0], NEPH_BUFFER_DEVICE, texels * texel_bytes, "light texels"},
        {&light->texels[1], NEPH_BUFFER_DEVICE, texels * texel_bytes, "light texels"},
        {&light->smoothed, NEPH_BUFFER_DEVICE, texels * 4 * sizeof(float), "light smoothed"},
    };
    return neph_buffers_create(light->vulkan, rows, sizeof(rows) / sizeof(rows[0]), diag);
}

/* Recreate the buffers if the size of the frame has changed; the history is then invalid. */
static enum neph_status resize_buffers(struct neph_traced_light *light, const uint32_t size_px[2],
                                       struct neph_diag *diag)
{
    if (light->size_px[0] == size_px[0] && light->size_px[1] == size_px[1])
        return NEPH_OK;
    destroy_sized(light);
    light->size_px[0] = size_px[0];
    light->size_px[1] = size_px[1];
    light->has_past = false;
    return create_sized(light, diag);
}

/* --- creation -------------------------------------------------------------------------------- */

enum neph_status neph_traced_light_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_traced_light *light, struct neph_diag *diag)
{
    light->vulkan = vulkan;
    light->params = *params;
    if (params->lighting != NEPH_MARCH_TRACED)
        return neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, 4 * sizeof(float), "no traced light",
                                  &light->smoothed, diag);
    uint64_t events;
    const enum neph_status status = neph_march_split_events(vulkan, scene, gpu, params, turns,
                                                            &events, diag);
    light->events = (uint32_t)(events < turns ? events : turns);
    const uint32_t size_px[2] = {(uint32_t)params->width_px, (uint32_t)params->height_px};
    return status ? status : resize_buffers(light, size_px, diag);
}

void neph_traced_light_destroy(struct neph_traced_light *light)
{
    if (!light->vulkan)
        return;
    destroy_sized(light);
    *light = (struct neph_traced_light){0};
}

/* --- rounds ---------------------------------------------------------------------------------- */

/* The work of a frame. */
struct work {
    struct neph_traced_light *light;
    const struct neph_dispatch *bound;
    const struct neph_kernel *walk, *settle, *smooth;
    struct neph_gpu_light_run run;
    struct neph_gpu_light_fade fade;
};

static uint32_t count_groups(uint32_t threads)
{
    return (threads + local_size - 1) / local_size;
}

/* The kernel of the paths. Its binding for empty cells has the majorants. It does not use grids as
 * textures: paths must not be affected by the rounding of filtering. */
static enum neph_status get_walk(struct neph_traced_light *light, const struct neph_gpu_scene *gpu,
                                 const struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_march_params march = light->params;
    struct neph_kernel_params params = {
        .name = "light_walk",
        .code = walk_code,
        .code_bytes = sizeof(walk_code),
        .buffer_count = NEPH_MARCH_BUFFERS,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .push_size_bytes = sizeof(struct neph_gpu_light_run),
        .constant_count = NEPH_MARCH_CONSTANTS + 3,
    };
    march.shortcuts.skip = march.shortcuts.grid_texture = false;
    neph_march_constants(gpu, &march, params.constants);
    const float similar = (float)march.light.similar;
    params.constants[NEPH_MARCH_CONSTANTS] = march.light.looks_ahead;
    memcpy(&params.constants[NEPH_MARCH_CONSTANTS + 1], &similar, sizeof(similar));
    params.constants[NEPH_MARCH_CONSTANTS + 2] = march.light.ends_ahead;
    return neph_kernel_get(light->vulkan, &params, kernel, diag);
}

static enum neph_status get_kernels(struct work *work, const struct neph_gpu_scene *gpu,
                                    struct neph_diag *diag)
{
    const struct neph_kernel_params settle = {
        .name = "light_settle",
        .code = settle_code,
        .code_bytes = sizeof(settle_code),
        .buffer_count = 4,
        .uniform_count = 1,
        .push_size_bytes = sizeof(struct neph_gpu_light_fade),
    };
    const struct neph_kernel_params smooth = {
        .name = "light_smooth",
        .code = smooth_code,
        .code_bytes = sizeof(smooth_code),
        .buffer_count = 2,
        .push_size_bytes = sizeof(struct neph_gpu_light_smooth),
    };
    struct neph_vulkan *vulkan = work->light->vulkan;
    enum neph_status status = get_walk(work->light, gpu, &work->walk, diag);
    if (!status)
        status = neph_kernel_get(vulkan, &settle, &work->settle, diag);
    return status ? status : neph_kernel_get(vulkan, &smooth, &work->smooth, diag);
}

static void add_walk(struct work *work, struct neph_batch *batch, struct neph_diag *diag)
{
    struct neph_traced_light *light = work->light;
    struct neph_dispatch dispatch = *work->bound;
    work->run.round = light->round;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &light->paths;
    dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &light->found;
    dispatch.push = &work->run;
    dispatch.group_count = count_groups(work->run.count);
    neph_batch_dispatch(batch, work->walk, &dispatch, diag);
}

static void add_settle(struct work *work, struct neph_batch *batch, struct neph_diag *diag)
{
    struct neph_traced_light *light = work->light;
    const uint32_t now = light->round % 2;
    const struct neph_dispatch dispatch = {
        .buffers = {work->bound->buffers[0], &light->found, &light->texels[1 - now],
                    &light->texels[now]},
        .push = &work->fade,
        .group_count = count_groups(texel_count(light)),
    };
    neph_batch_dispatch(batch, work->settle, &dispatch, diag);
}

static void add_smooth(struct work *work, struct neph_batch *batch, struct neph_diag *diag)
{
    struct neph_traced_light *light = work->light;
    const struct neph_gpu_light_smooth smooth = {
        .size = {count_texels_along(light, 0), count_texels_along(light, 1)},
        .sigma = (float)light->params.light.blur_texels,
    };
    const struct neph_dispatch dispatch = {
        .buffers = {&light->texels[light->round % 2], &light->smoothed},
        .push = &smooth,
        .group_count = count_groups(texel_count(light)),
    };
    neph_batch_dispatch(batch, work->smooth, &dispatch, diag);
}

static enum neph_status run_round(struct work *work, bool is_last, double *gpu_s,
                                  struct neph_diag *diag)
{
    struct neph_batch batch;
    if (neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "traced light: interrupted");
    work->light->round++;
    neph_batch_begin(work->light->vulkan, &batch, diag);
    add_walk(work, &batch, diag);
    neph_batch_barrier(&batch);
    add_settle(work, &batch, diag);
    if (is_last) {
        neph_batch_barrier(&batch);
        add_smooth(work, &batch, diag);
    }
    neph_batch_stamp(&batch, gpu_s);
    return neph_batch_submit(&batch, "traced light", diag);
}

/* --- a frame --------------------------------------------------------------------------------- */

/* Displacement relative to the camera of a point that moves with the wind. */
static struct neph_vec3 compute_shift(const struct neph_traced_light_view *from,
                                      const struct neph_traced_light_view *to)
{
    return neph_vec3_sub(neph_vec3_sub(to->drift_m, from->drift_m),
                         neph_vec3_sub(to->camera.position_m, from->camera.position_m));
}

static void set_fade(const struct neph_traced_light *light,
                     const struct neph_traced_light_view *view, bool continues,
                     struct neph_gpu_light_fade *fade)
{
    const struct neph_traced_light_view *before = continues ? &light->past : view;
    const double half_height = neph_camera_half_height(&before->camera);
    *fade = (struct neph_gpu_light_fade){
        .half_width = before->half_width,
        .half_height = (float)half_height,
        .keep = continues ? (float)(1.0 - 1.0 / light->params.light.memory) : 0.0f,
        .paths = (uint32_t)light->params.light.paths,
        .size_px = {light->size_px[0], light->size_px[1]},
        .texel_px = (uint32_t)light->params.light.texel_px,
        .is_parallel = view->camera.orthographic_height_m > 0.0,
    };
    neph_gpu_direction(fade->right, before->camera.right);
    neph_gpu_direction(fade->up, before->camera.up);
    neph_gpu_direction(fade->forward, before->camera.forward);
    neph_gpu_direction(fade->position_m, compute_shift(before, view));
}

/* Warm-up rounds before the first frame of a sequence. */
static const int warm_up_rounds = 8;

/* Number of warm-up rounds, whose results are discarded. Paths that are unfinished after the last
 * round are lost; in a steady state they are compensated by paths already in progress when counting
 * begins. Without that state the result would be too dark. Not needed when unfinished paths are
 * estimated. */
static int count_warm_up_rounds(const struct neph_traced_light *light, bool continues)
{
    if (continues || light->params.light.looks_ahead)
        return 0;
    return light->params.light.memory == 1 ? (light->params.light.rounds + 1) / 2 : warm_up_rounds;
}

static enum neph_status run_rounds(struct work *work, int unseen, double *gpu_s,
                                   struct neph_diag *diag)
{
    const int seen = work->light->params.light.rounds;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < unseen + seen && !status; i++) {
        status = run_round(work, i + 1 == unseen + seen, gpu_s, diag);
        neph_gpu_direction(work->run.shift_m, (struct neph_vec3){0.0, 0.0, 0.0});
        work->run.is_fresh = 0;
        if (i >= unseen) {
            work->fade.keep = 1.0f;
            work->fade.is_still = 1;
        }
    }
    return status;
}

enum neph_status neph_traced_light_trace(struct neph_traced_light *light,
                                         const struct neph_scene *scene,
                                         const struct neph_gpu_scene *gpu,
                                         const struct neph_dispatch *bound,
                                         const struct neph_traced_light_view *view, bool continues,
                                         double *gpu_s, struct neph_diag *diag)
{
    if (light->params.lighting != NEPH_MARCH_TRACED)
        return NEPH_OK;
    const uint32_t size_px[2] = {gpu->frame->width_px, gpu->frame->height_px};
    struct work work = {.light = light, .bound = bound};
    enum neph_status status = resize_buffers(light, size_px, diag);
    if (!status)
        status = get_kernels(&work, gpu, diag);
    if (status)
        return status;
    continues = continues && light->has_past && light->params.light.memory > 1;
    if (!continues)
        light->round = 0;
    work.run = (struct neph_gpu_light_run){
        .seed = light->params.light.seed,
        .paths = (uint32_t)light->params.light.paths,
        .turns = turns,
        .events = light->events,
        .count = path_count(light),
        .is_fresh = !continues,
        .has_environment = scene->environment_light,
    };
    set_fade(light, view, continues, &work.fade);
    if (continues)
        neph_gpu_direction(work.run.shift_m, compute_shift(&light->past, view));
    status = run_rounds(&work, count_warm_up_rounds(light, continues), gpu_s, diag);
    light->has_past = !status;
    light->past = *view;
    return status;
}

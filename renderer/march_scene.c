/* SPDX-License-Identifier: MIT */
#include "renderer/march_scene.h"

#include "renderer/grid_textures.h"
#include "scenes/motion.h"

static enum neph_status create_turns(const struct neph_vulkan *vulkan,
                                     struct neph_march_scene *scene, struct neph_diag *diag)
{
    const enum neph_status status = neph_turns_create(vulkan, &scene->gpu.buffers[0], "scene frame",
                                                      &scene->frame_turns, diag);
    return status ? status
                  : neph_turns_create(vulkan, &scene->gpu.buffers[1], "scene solids",
                                      &scene->solid_turns, diag);
}

enum neph_status neph_march_scene_create(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                         const struct neph_march_params *params,
                                         struct neph_march_scene *scene, struct neph_diag *diag)
{
    const bool traces = params->lighting == NEPH_MARCH_TRACED;
    enum neph_status status = neph_gpu_scene_create(vulkan, from, params->frame, params->width_px,
                                                    params->height_px, traces, &scene->gpu, diag);
    if (!status)
        status = neph_grid_textures_create(vulkan, from, &params->shortcuts, &scene->gpu, diag);
    if (!status)
        status = create_turns(vulkan, scene, diag);
    if (!status)
        status = neph_skip_cells_create(vulkan, from, params, &scene->skip_cells, diag);
    if (!status)
        status = neph_cloud_shadow_create(vulkan, from, &scene->gpu, params, &scene->cloud_shadow,
                                          diag);
    if (!status)
        status = neph_sun_cache_create(vulkan, from, &scene->gpu, params,
                                       neph_cloud_shadow_values(&scene->cloud_shadow),
                                       &scene->sun_cache, diag);
    if (!status)
        status = neph_traced_light_create(vulkan, from, &scene->gpu, params, &scene->traced_light,
                                          diag);
    if (!status)
        status = neph_diffused_light_create(vulkan, from, &scene->gpu, params,
                                            &scene->diffused_light, diag);
    return status ? status : neph_slab_light_create(vulkan, from, params, &scene->slab_light, diag);
}

void neph_march_scene_destroy(const struct neph_vulkan *vulkan, struct neph_march_scene *scene)
{
    neph_slab_light_destroy(&scene->slab_light);
    neph_diffused_light_destroy(&scene->diffused_light);
    neph_traced_light_destroy(&scene->traced_light);
    neph_cloud_shadow_destroy(&scene->cloud_shadow);
    neph_sun_cache_destroy(&scene->sun_cache);
    neph_skip_cells_destroy(vulkan, &scene->skip_cells);
    neph_turns_destroy(vulkan, &scene->solid_turns);
    neph_turns_destroy(vulkan, &scene->frame_turns);
    neph_gpu_scene_destroy(vulkan, &scene->gpu);
}

/* The scene itself. */
static void show_scene(const struct neph_scene *from, const struct neph_march_params *params,
                       double frame, struct neph_march_scene *scene)
{
    neph_turns_take(&scene->frame_turns, &scene->gpu.buffers[0]);
    neph_turns_take(&scene->solid_turns, &scene->gpu.buffers[1]);
    scene->gpu.frame = scene->gpu.buffers[0].mapped;
    neph_gpu_scene_move(&scene->gpu, from, frame, params->width_px, params->height_px);
    neph_march_set_frame(from, params, scene->gpu.frame);
}

static bool diffuses(const struct neph_march_scene *scene)
{
    return scene->diffused_light.level_count > 0;
}

/* What a march shows of higher orders, or paths look ahead to. Where they take that back, it has no
 * part in the mean (light_walk.comp), and is solved once, when pictures begin. */
static enum neph_status diffuse(const struct neph_scene *from, double frame,
                                const struct neph_march_moment *moment,
                                struct neph_march_scene *scene, struct neph_dispatch bound,
                                double *gpu_s, struct neph_diag *diag)
{
    struct neph_diffused_light *light = &scene->diffused_light;
    const struct neph_light_paths *paths = &scene->traced_light.params.light;
    if (paths->looks_ahead && !paths->ends_ahead && moment->continues && light->is_filled) {
        neph_diffused_light_place(light, from, frame, &scene->gpu);
        return NEPH_OK;
    }
    neph_skip_cells_bind(&scene->skip_cells, &bound);
    return neph_diffused_light_solve(light, from, frame, &scene->gpu, &bound, moment->continues,
                                     scene->sun_cache.fill.stale_parts > 0, gpu_s, diag);
}

/* Light of higher orders, of whichever kind. Paths have majorants in place of skipped cells. */
static enum neph_status find_light(const struct neph_scene *from, double frame,
                                   const struct neph_march_moment *moment,
                                   struct neph_march_scene *scene, double *gpu_s,
                                   struct neph_diag *diag)
{
    struct neph_dispatch bound = {.group_count = 0};
    const struct neph_light_moment view = {neph_scene_camera(from, frame), moment->drift_m,
                                           scene->gpu.frame->half_width};
    neph_gpu_scene_bind(&scene->gpu, &bound);
    bound.buffers[NEPH_GPU_SCENE_BUFFERS + 2] = &scene->sun_cache.nodes;
    bound.buffers[NEPH_GPU_SCENE_BUFFERS + 3] = diffuses(scene) ? &scene->diffused_light.field
                                                                : &scene->traced_light.smoothed;
    const enum neph_status status = diffuse(from, frame, moment, scene, bound, gpu_s, diag);
    return status ? status
                  : neph_traced_light_trace(&scene->traced_light, from, &scene->gpu, &bound, &view,
                                            moment->continues, gpu_s, diag);
}

enum neph_status neph_march_scene_show(const struct neph_scene *from,
                                       const struct neph_march_params *params, double frame,
                                       const struct neph_march_moment *moment,
                                       struct neph_march_scene *scene,
                                       struct neph_march_scene_cost *cost, struct neph_diag *diag)
{
    *cost->fill = (struct neph_sun_fill_cost){.dispatches = 0};
    show_scene(from, params, frame, scene);
    enum neph_status status = neph_skip_cells_place(&scene->skip_cells, from, frame,
                                                    scene->gpu.frame, diag);
    if (!status)
        status = neph_sun_cache_fill(&scene->sun_cache, from, frame, &scene->gpu,
                                     &scene->skip_cells, cost->fill, diag);
    if (!status)
        status = neph_cloud_shadow_fill(&scene->cloud_shadow, from, frame, &scene->gpu,
                                        &scene->skip_cells, &scene->sun_cache, cost->fill, diag);
    return status ? status : find_light(from, frame, moment, scene, cost->light_gpu_s, diag);
}

static const struct neph_buffer *higher_orders(const struct neph_march_scene *scene)
{
    if (diffuses(scene) && scene->diffused_light.is_shown)
        return &scene->diffused_light.field;
    return scene->slab_light.vulkan ? &scene->slab_light.table : &scene->traced_light.smoothed;
}

void neph_march_scene_bind(const struct neph_march_scene *scene, struct neph_dispatch *dispatch)
{
    neph_gpu_scene_bind(&scene->gpu, dispatch);
    neph_skip_cells_bind(&scene->skip_cells, dispatch);
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 2] = &scene->sun_cache.nodes;
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 3] = higher_orders(scene);
}

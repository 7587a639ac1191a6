/* SPDX-License-Identifier: MIT */
#include "renderer/march_scene.h"

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
    enum neph_status status = neph_gpu_scene_create(vulkan, from, params->frame, params->width_px,
                                                    params->height_px, false, &scene->gpu, diag);
    if (!status)
        status = create_turns(vulkan, scene, diag);
    if (!status)
        status = neph_skip_cells_create(vulkan, from, params, &scene->skip_cells, diag);
    if (!status)
        status = neph_sun_cache_create(vulkan, from, &scene->gpu, params, &scene->sun_cache, diag);
    return status;
}

void neph_march_scene_destroy(const struct neph_vulkan *vulkan, struct neph_march_scene *scene)
{
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

enum neph_status neph_march_scene_show(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                       const struct neph_march_params *params, double frame,
                                       struct neph_march_scene *scene,
                                       struct neph_sun_cache_cost *cost, struct neph_diag *diag)
{
    show_scene(from, params, frame, scene);
    enum neph_status status = neph_skip_cells_place(&scene->skip_cells, from, frame,
                                                    scene->gpu.frame, diag);
    /* Frames in flight may still read the nodes: they land first, and their times stay theirs. */
    if (!status && neph_sun_cache_is_stale(&scene->sun_cache, from, &scene->gpu))
        status = neph_batches_wait(vulkan, neph_batches_sent(vulkan), "frames in flight", diag);
    return status ? status
                  : neph_sun_cache_fill(&scene->sun_cache, from, frame, &scene->gpu,
                                        &scene->skip_cells, cost, diag);
}

void neph_march_scene_bind(const struct neph_march_scene *scene, struct neph_dispatch *dispatch)
{
    neph_gpu_scene_bind(&scene->gpu, dispatch);
    neph_skip_cells_bind(&scene->skip_cells, dispatch);
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 2] = &scene->sun_cache.nodes;
}

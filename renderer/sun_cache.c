/* SPDX-License-Identifier: MIT */
#include "renderer/sun_cache.h"

#include "renderer/lattice.h"
#include "scenes/motion.h"

#include <math.h>

static const uint32_t sun_cache_code[] = {
#include "shaders/sun_cache.comp.inc"
};

/* --- creation ------------------------------------------------------------------------------- */

static uint64_t node_count(const struct neph_sun_cache *cache)
{
    return (uint64_t)cache->size[0] * cache->size[1] * cache->size[2];
}

/* A node needs the work of one step of a march. */
static enum neph_status plan_node_dispatches(struct neph_sun_cache *cache,
                                             const struct neph_scene *scene,
                                             const struct neph_gpu_scene *gpu,
                                             const struct neph_march_params *params,
                                             struct neph_diag *diag)
{
    static const struct neph_sun_fill_shader shader = {"sun_cache", sun_cache_code,
                                                       sizeof(sun_cache_code), NEPH_SUN_CACHE};
    struct neph_march_params one_step = *params;
    struct neph_march_split cut;
    one_step.steps = 1;
    const enum neph_status status = neph_march_split_make(cache->vulkan, scene, gpu, &one_step,
                                                          node_count(cache), &cut, diag);
    return status
               ? status
               : neph_sun_fill_create(cache->vulkan, &shader, params,
                                      params->shortcuts.sun_cache_frames, &cut, &cache->fill, diag);
}

enum neph_status neph_sun_cache_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, size_t values_behind,
                                       struct neph_sun_cache *cache, struct neph_diag *diag)
{
    struct neph_bounds box;
    cache->vulkan = vulkan;
    const bool has_lattice = params->shortcuts.sun_cache && neph_find_media_bounds(scene, &box);
    enum neph_status status =
        has_lattice ? neph_lattice_check(&box, "sun_cache=grid", "sun_cache=off", diag) : NEPH_OK;
    if (!status && has_lattice) {
        neph_lattice_nodes(&box, params->shortcuts.sun_cache_voxels, cache->size);
        status = plan_node_dispatches(cache, scene, gpu, params, diag);
    }
    const size_t channels = gpu->constants[1] & NEPH_GPU_COLOURED ? 3 : 1;
    cache->value_count = has_lattice ? channels * node_count(cache) : 0;
    const size_t values = cache->value_count + values_behind;
    return status ? status
                  : neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE,
                                       (values > 0 ? values : 1) * sizeof(float), "sun cache",
                                       &cache->nodes, diag);
}

void neph_sun_cache_destroy(struct neph_sun_cache *cache)
{
    if (!cache->vulkan)
        return;
    neph_sun_fill_destroy(&cache->fill);
    neph_buffer_destroy(cache->vulkan, &cache->nodes);
    *cache = (struct neph_sun_cache){0};
}

/* --- filling -------------------------------------------------------------------------------- */

static void place_light_grid(const struct neph_sun_cache *cache, const struct neph_scene *scene,
                             double frame, struct neph_gpu_lattice *lattice)
{
    struct neph_bounds box = {0};
    neph_find_media_bounds(scene, &box);
    neph_lattice_place(&box, neph_scene_camera(scene, frame).position_m, cache->size, 1, lattice);
}

enum neph_status neph_sun_cache_fill(struct neph_sun_cache *cache, const struct neph_scene *scene,
                                     double frame, const struct neph_gpu_scene *gpu,
                                     const struct neph_skip_cells *skip,
                                     struct neph_sun_fill_cost *cost, struct neph_diag *diag)
{
    if (cache->size[0] == 0 || !gpu->frame->scatters)
        return NEPH_OK;
    place_light_grid(cache, scene, frame, &gpu->frame->sun_lattice);
    return neph_sun_fill_run(&cache->fill, scene, gpu, skip, &cache->nodes, false, cost, diag);
}

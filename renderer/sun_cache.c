/* SPDX-License-Identifier: MIT */
#include "renderer/sun_cache.h"

#include "renderer/lattice.h"
#include "scenes/motion.h"

#include <math.h>
#include <string.h>

static const uint32_t sun_cache_spirv[] = {
#include "shaders/sun_cache.comp.inc"
};

/* --- where it lies -------------------------------------------------------------------------- */

/* Cubes, as near as whole numbers of them come to the box. */
static void choose_size(const struct neph_bounds *box, int voxels, uint32_t size[3])
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double longest_m = fmax(sides_m[0], fmax(sides_m[1], sides_m[2]));
    for (int axis = 0; axis < 3; axis++)
        size[axis] = 1 + (uint32_t)fmax(1.0, ceil((voxels - 1) * sides_m[axis] / longest_m - 1e-9));
}

/* --- making --------------------------------------------------------------------------------- */

static uint64_t node_count(const struct neph_sun_cache *cache)
{
    return (uint64_t)cache->size[0] * cache->size[1] * cache->size[2];
}

static const char counters_name[] = "sun cache counters";

/* A node's ray is that of one step of a march. */
static enum neph_status plan(struct neph_sun_cache *cache, const struct neph_scene *scene,
                             const struct neph_gpu_scene *gpu, struct neph_diag *diag)
{
    cache->params.steps = 1;
    enum neph_status status = neph_march_cut_make(cache->vulkan, scene, gpu, &cache->params,
                                                  node_count(cache), &cache->cut, diag);
    if (!status)
        status = neph_buffer_create(cache->vulkan, NEPH_BUFFER_UPLOAD,
                                    sizeof(struct neph_gpu_sun_counters), counters_name,
                                    &cache->counters, diag);
    if (!status)
        status = neph_turns_create(cache->vulkan, &cache->counters, counters_name,
                                   &cache->counter_turns, diag);
    return status;
}

enum neph_status neph_sun_cache_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params,
                                       struct neph_sun_cache *cache, struct neph_diag *diag)
{
    struct neph_bounds box;
    cache->vulkan = vulkan;
    cache->params = *params;
    const bool has_lattice = params->shortcuts.sun_cache && neph_shapes_box(scene, &box);
    enum neph_status status =
        has_lattice ? neph_lattice_check(&box, "sun_cache=grid", "sun_cache=off", diag) : NEPH_OK;
    if (!status && has_lattice) {
        choose_size(&box, params->shortcuts.sun_cache_voxels, cache->size);
        status = plan(cache, scene, gpu, diag);
    }
    const size_t channels = gpu->constants[1] & NEPH_GPU_COLOURED ? 3 : 1;
    const size_t values = has_lattice ? channels * node_count(cache) : 1;
    return status ? status
                  : neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, values * sizeof(float),
                                       "sun cache", &cache->nodes, diag);
}

void neph_sun_cache_destroy(struct neph_sun_cache *cache)
{
    if (!cache->vulkan)
        return;
    neph_turns_destroy(cache->vulkan, &cache->counter_turns);
    neph_buffer_destroy(cache->vulkan, &cache->counters);
    neph_buffer_destroy(cache->vulkan, &cache->nodes);
    *cache = (struct neph_sun_cache){0};
}

/* --- filling -------------------------------------------------------------------------------- */

static void place(const struct neph_sun_cache *cache, const struct neph_scene *scene, double frame,
                  struct neph_gpu_lattice *lattice)
{
    struct neph_bounds box = {0};
    neph_shapes_box(scene, &box);
    neph_lattice_place(&box, neph_scene_camera(scene, frame).position_m, cache->size, 1, lattice);
}

/* A fill in work. */
struct work {
    struct neph_sun_cache *cache;
    const struct neph_kernel *kernel;
    struct neph_dispatch dispatch;
    uint64_t first_node;
    struct neph_sun_cache_cost *cost; /* borrowed */
};

static enum neph_status send_run(const struct neph_gpu_march_run *run, void *context,
                                 struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_gpu_march_run nodes = *run;
    struct neph_batch batch;
    nodes.first_ray += (uint32_t)work->first_node;
    work->dispatch.push = &nodes;
    work->dispatch.group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) /
                                 NEPH_MARCH_LOCAL_SIZE;
    enum neph_status status = neph_batch_begin(work->cache->vulkan, &batch, diag);
    if (!status)
        status = neph_batch_dispatch(&batch, work->kernel, &work->dispatch, diag);
    if (status)
        return status;
    neph_batch_stamp(&batch, &work->cost->gpu_s);
    work->cost->dispatches++;
    return neph_batch_send(&batch, "sun cache", diag);
}

static enum neph_status get_kernel(struct neph_sun_cache *cache, const struct neph_gpu_scene *gpu,
                                   const struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = "sun_cache",
        .spirv = sun_cache_spirv,
        .spirv_size_bytes = sizeof(sun_cache_spirv),
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 2,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(gpu, &cache->params, params.constants);
    return neph_kernel_get(cache->vulkan, &params, kernel, diag);
}

static void begin_count(struct neph_sun_cache *cache, struct neph_sun_cache_cost *cost)
{
    neph_turns_take(&cache->counter_turns, &cache->counters);
    memset(cache->counters.mapped, 0, sizeof(struct neph_gpu_sun_counters));
    cost->counters = cache->counters.mapped;
}

/* Nodes from one up to another. */
static enum neph_status fill(struct neph_sun_cache *cache, const uint64_t nodes[2],
                             const struct neph_gpu_scene *gpu, const struct neph_skip_cells *skip,
                             struct neph_sun_cache_cost *cost, struct neph_diag *diag)
{
    struct work work = {.cache = cache, .first_node = nodes[0], .cost = cost};
    struct neph_march_cut cut = cache->cut;
    cut.ray_count = nodes[1] - nodes[0];
    begin_count(cache, cost);
    neph_gpu_scene_bind(gpu, &work.dispatch);
    neph_skip_cells_bind(skip, &work.dispatch);
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &cache->nodes;
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &cache->counters;
    const enum neph_status status = get_kernel(cache, gpu, &work.kernel, diag);
    return status ? status : neph_march_cut_run(&cut, send_run, &work, diag);
}

static uint64_t whole_number(const uint32_t halves[2])
{
    return halves[0] | (uint64_t)halves[1] << 32;
}

void neph_sun_cache_counts(const struct neph_sun_cache_cost *cost, uint64_t *density_evaluations,
                           uint64_t *closed_forms)
{
    static const struct neph_gpu_sun_counters none;
    const struct neph_gpu_sun_counters *counters = cost->counters ? cost->counters : &none;
    *density_evaluations = whole_number(counters->density_evaluations);
    *closed_forms = whole_number(counters->closed_forms);
}

/* --- what is stale --------------------------------------------------------------------------- */

static bool is_used(const struct neph_sun_cache *cache, const struct neph_gpu_scene *gpu)
{
    return cache->size[0] > 0 && gpu->frame->scatters;
}

/* Parts that a new filling takes. */
static int part_count(const struct neph_sun_cache *cache)
{
    const int pictures = cache->params.shortcuts.sun_cache_frames;
    return pictures > 1 ? pictures : 1;
}

/* Sun or media have moved since the newest filling: all parts are stale, from the next on. */
static void find_stale(struct neph_sun_cache *cache, const struct neph_scene *scene)
{
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
    neph_gpu_scene_media(scene, media);
    if (neph_gpu_same_sun(&scene->sun, &cache->sun) &&
        memcmp(media, cache->media, sizeof(media)) == 0)
        return;
    cache->sun = scene->sun;
    memcpy(cache->media, media, sizeof(media));
    cache->stale_parts = part_count(cache);
}

/* The nodes to fill for this picture: all of them at first. */
static void take_part(struct neph_sun_cache *cache, uint64_t nodes[2])
{
    const uint64_t all = node_count(cache), parts = (uint64_t)part_count(cache);
    nodes[0] = cache->is_filled ? all * (uint64_t)cache->part / parts : 0;
    nodes[1] = cache->is_filled ? all * ((uint64_t)cache->part + 1) / parts : all;
    cache->stale_parts = cache->is_filled ? cache->stale_parts - 1 : 0;
    cache->part = (cache->part + 1) % part_count(cache);
}

enum neph_status neph_sun_cache_fill(struct neph_sun_cache *cache, const struct neph_scene *scene,
                                     double frame, const struct neph_gpu_scene *gpu,
                                     const struct neph_skip_cells *skip,
                                     struct neph_sun_cache_cost *cost, struct neph_diag *diag)
{
    uint64_t nodes[2];
    *cost = (struct neph_sun_cache_cost){0};
    if (!is_used(cache, gpu))
        return NEPH_OK;
    place(cache, scene, frame, &gpu->frame->sun_lattice);
    find_stale(cache, scene);
    if (cache->is_filled && cache->stale_parts == 0)
        return NEPH_OK;
    take_part(cache, nodes);
    const enum neph_status status = nodes[0] < nodes[1] ? fill(cache, nodes, gpu, skip, cost, diag)
                                                        : NEPH_OK;
    cache->is_filled = !status;
    return status;
}

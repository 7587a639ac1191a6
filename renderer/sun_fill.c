/* SPDX-License-Identifier: MIT */
#include "renderer/sun_fill.h"

#include <string.h>

static const char counters_name[] = "sun counters";

enum neph_status neph_sun_fill_create(struct neph_vulkan *vulkan,
                                      const struct neph_sun_fill_shader *shader,
                                      const struct neph_march_params *params, int pictures,
                                      const struct neph_march_split *cut,
                                      struct neph_sun_fill *fill, struct neph_diag *diag)
{
    fill->vulkan = vulkan;
    fill->shader = *shader;
    fill->params = *params;
    fill->part_count = pictures > 1 ? pictures : 1;
    fill->cut = *cut;
    const enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD,
                                                       sizeof(struct neph_gpu_sun_counters),
                                                       counters_name, &fill->counters, diag);
    return status ? status
                  : neph_buffer_ring_create(vulkan, &fill->counters, counters_name,
                                            &fill->counter_ring, diag);
}

void neph_sun_fill_destroy(struct neph_sun_fill *fill)
{
    if (!fill->vulkan)
        return;
    neph_buffer_ring_destroy(fill->vulkan, &fill->counter_ring);
    neph_buffer_destroy(fill->vulkan, &fill->counters);
    *fill = (struct neph_sun_fill){0};
}

/* --- filling -------------------------------------------------------------------------------- */

/* The work of a filling. */
struct work {
    struct neph_sun_fill *fill;
    const struct neph_kernel *kernel;
    struct neph_dispatch dispatch;
    uint64_t first_entry;
    struct neph_sun_fill_cost *cost; /* borrowed */
};

static enum neph_status submit_fill_run(const struct neph_gpu_march_run *run, void *context,
                                        struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_gpu_march_run entries = *run;
    entries.first_ray += (uint32_t)work->first_entry;
    work->dispatch.push = &entries;
    work->dispatch.group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) /
                                 NEPH_MARCH_LOCAL_SIZE;
    work->cost->dispatches++;
    return neph_dispatch_submit(work->fill->vulkan, work->kernel, &work->dispatch,
                                work->fill->shader.name,
                                &work->cost->gpu_s[work->fill->shader.table], diag);
}

static enum neph_status get_kernel(struct neph_sun_fill *fill, const struct neph_gpu_scene *gpu,
                                   const struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = fill->shader.name,
        .code = fill->shader.code,
        .code_bytes = fill->shader.code_bytes,
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 2,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .texels_first = NEPH_GPU_VALUES_BUFFER,
        .texels_count = {[1] = 1}, /* pairs */
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(gpu, &fill->params, params.constants);
    return neph_kernel_get(fill->vulkan, &params, kernel, diag);
}

static void reset_counters(struct neph_sun_fill *fill, struct neph_sun_fill_cost *cost)
{
    neph_buffer_ring_advance(&fill->counter_ring, &fill->counters);
    memset(fill->counters.mapped, 0, sizeof(struct neph_gpu_sun_counters));
    cost->counters[fill->shader.table] = fill->counters.mapped;
}

/* Fill the entries entries[0] .. entries[1] - 1. */
static enum neph_status run(struct neph_sun_fill *fill, const uint64_t entries[2],
                            const struct neph_gpu_scene *gpu, const struct neph_skip_cells *skip,
                            const struct neph_buffer *table, struct neph_sun_fill_cost *cost,
                            struct neph_diag *diag)
{
    struct work work = {.fill = fill, .first_entry = entries[0], .cost = cost};
    struct neph_march_split cut = fill->cut;
    cut.ray_count = entries[1] - entries[0];
    reset_counters(fill, cost);
    neph_gpu_scene_bind(gpu, &work.dispatch);
    neph_skip_cells_bind(skip, &work.dispatch);
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = table;
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &fill->counters;
    const enum neph_status status = get_kernel(fill, gpu, &work.kernel, diag);
    return status ? status : neph_march_split_run(&cut, submit_fill_run, &work, diag);
}

/* --- stale parts ----------------------------------------------------------------------------- */

/* Mark all parts as stale, starting with the next, if sun or media have changed since the last
 * filling. */
static void mark_stale_parts(struct neph_sun_fill *fill, const struct neph_scene *scene)
{
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
    neph_gpu_scene_pack_media(scene, media);
    if (neph_gpu_is_same_sun(&scene->sun, &fill->sun) &&
        memcmp(media, fill->media, sizeof(media)) == 0)
        return;
    fill->sun = scene->sun;
    memcpy(fill->media, media, sizeof(media));
    fill->stale_parts = fill->part_count;
}

/* Choose the entries to fill in this frame: the next part; all entries in the first filling. */
static void choose_stale_part(struct neph_sun_fill *fill, uint64_t entries[2])
{
    const uint64_t all = fill->cut.ray_count, parts = (uint64_t)fill->part_count;
    entries[0] = fill->is_filled ? all * (uint64_t)fill->part / parts : 0;
    entries[1] = fill->is_filled ? all * ((uint64_t)fill->part + 1) / parts : all;
    fill->stale_parts = fill->is_filled ? fill->stale_parts - 1 : 0;
    fill->part = (fill->part + 1) % fill->part_count;
}

enum neph_status neph_sun_fill_run(struct neph_sun_fill *fill, const struct neph_scene *scene,
                                   const struct neph_gpu_scene *gpu,
                                   const struct neph_skip_cells *skip,
                                   const struct neph_buffer *table, bool anew,
                                   struct neph_sun_fill_cost *cost, struct neph_diag *diag)
{
    uint64_t entries[2];
    fill->is_filled = fill->is_filled && !anew;
    mark_stale_parts(fill, scene);
    if (fill->is_filled && fill->stale_parts == 0)
        return NEPH_OK;
    choose_stale_part(fill, entries);
    const enum neph_status status = entries[0] < entries[1]
                                        ? run(fill, entries, gpu, skip, table, cost, diag)
                                        : NEPH_OK;
    fill->is_filled = !status;
    return status;
}

/* --- costs ----------------------------------------------------------------------------------- */

double neph_sun_fill_gpu_s(const struct neph_sun_fill_cost *cost)
{
    double sum_s = 0.0;
    for (int t = 0; t < NEPH_SUN_TABLES; t++)
        sum_s += cost->gpu_s[t];
    return sum_s;
}

static uint64_t join_halves(const uint32_t halves[2])
{
    return halves[0] | (uint64_t)halves[1] << 32;
}

void neph_sun_fill_counts(const struct neph_sun_fill_cost *cost, uint64_t *density_evaluations,
                          uint64_t *closed_forms)
{
    *density_evaluations = *closed_forms = 0;
    for (int t = 0; t < NEPH_SUN_TABLES; t++) {
        const struct neph_gpu_sun_counters *counters = cost->counters[t];
        *density_evaluations += counters ? join_halves(counters->density_evaluations) : 0;
        *closed_forms += counters ? join_halves(counters->closed_forms) : 0;
    }
}

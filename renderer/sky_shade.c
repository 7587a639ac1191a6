/* SPDX-License-Identifier: MIT */
#include "renderer/sky_shade.h"

#include <string.h>

static const uint32_t sunlit_code[] = {
#include "shaders/sky_sunlit.comp.inc"
};

static uint64_t froxel_count(const struct neph_sky_aerial_params *aerial)
{
    return (uint64_t)aerial->columns * (uint64_t)aerial->rows * (uint64_t)aerial->slices;
}

enum neph_status neph_sky_shade_create(struct neph_vulkan *vulkan, const struct neph_scene *rest,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params,
                                       struct neph_sky_shade *shade, struct neph_diag *diag)
{
    static const char name[] = "sky counters";
    if (!params->sky.has_shadows || (rest->medium_count == 0 && rest->solid_count < 2))
        return NEPH_OK;
    const uint64_t samples = NEPH_GPU_SKY_SUN_SAMPLES;
    shade->vulkan = vulkan;
    shade->params = *params;
    enum neph_status status = neph_march_split_make_whole(
        vulkan, rest, gpu, params, samples * neph_gpu_solid_iterations(rest), samples,
        froxel_count(&params->sky.tables.aerial), &shade->cut, diag);
    if (!status)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD,
                                    sizeof(struct neph_gpu_sun_counters), name, &shade->counters,
                                    diag);
    return status ? status
                  : neph_buffer_ring_create(vulkan, &shade->counters, name, &shade->counter_ring,
                                            diag);
}

void neph_sky_shade_destroy(struct neph_sky_shade *shade)
{
    if (!shade->vulkan)
        return;
    neph_buffer_ring_destroy(shade->vulkan, &shade->counter_ring);
    neph_buffer_destroy(shade->vulkan, &shade->counters);
    *shade = (struct neph_sky_shade){.vulkan = NULL};
}

/* --- filling ---------------------------------------------------------------------------------- */

struct work {
    const struct neph_sky_shade *shade;
    const struct neph_kernel *kernel;
    struct neph_dispatch dispatch;
    struct neph_sun_fill_cost *cost; /* borrowed, as gpu_s */
    double *gpu_s;
};

static enum neph_status get_kernel(const struct neph_sky_shade *shade,
                                   const struct neph_gpu_scene *gpu,
                                   const struct neph_kernel **kernel, struct neph_diag *diag)
{
    struct neph_kernel_params params = {
        .name = "sky_sunlit",
        .code = sunlit_code,
        .code_bytes = sizeof(sunlit_code),
        .buffer_count = NEPH_MARCH_BUFFERS,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .push_size_bytes = sizeof(struct neph_gpu_march_run),
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(gpu, &shade->params, params.constants);
    return neph_kernel_get(shade->vulkan, &params, kernel, diag);
}

static enum neph_status submit_shade_run(const struct neph_gpu_march_run *run, void *context,
                                         struct neph_diag *diag)
{
    struct work *work = context;
    work->dispatch.push = run;
    work->dispatch.group_count = (run->ray_count + NEPH_MARCH_LOCAL_SIZE - 1) /
                                 NEPH_MARCH_LOCAL_SIZE;
    work->cost->dispatches++;
    return neph_dispatch_submit(work->shade->vulkan, work->kernel, &work->dispatch,
                                "the sky's shadows", work->gpu_s, diag);
}

/* Whether media are unchanged. Scenes with moving solids always count as changed. */
static bool has_same_media(struct neph_sky_shade *shade, const struct neph_scene *rest,
                           const struct neph_sky_tables *tables)
{
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
    neph_gpu_scene_pack_media(rest, media);
    const bool same = tables->has_aerial && !rest->unmoved_solids &&
                      memcmp(media, shade->media, sizeof(media)) == 0;
    memcpy(shade->media, media, sizeof(media));
    return same;
}

enum neph_status neph_sky_shade_fill(struct neph_sky_shade *shade, const struct neph_scene *rest,
                                     const struct neph_gpu_scene *gpu,
                                     const struct neph_dispatch *bound,
                                     struct neph_sky_tables *tables,
                                     struct neph_sun_fill_cost *cost, double *gpu_s,
                                     struct neph_diag *diag)
{
    struct work work = {.shade = shade, .dispatch = *bound, .cost = cost, .gpu_s = gpu_s};
    if (!shade->vulkan || has_same_media(shade, rest, tables))
        return NEPH_OK;
    tables->has_aerial = false;
    neph_buffer_ring_advance(&shade->counter_ring, &shade->counters);
    memset(shade->counters.mapped, 0, sizeof(struct neph_gpu_sun_counters));
    cost->counters[NEPH_SUN_SKY] = shade->counters.mapped;
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS] = &shade->counters; /* unused bindings */
    work.dispatch.buffers[NEPH_GPU_SCENE_BUFFERS + 1] = &shade->counters;
    const enum neph_status status = get_kernel(shade, gpu, &work.kernel, diag);
    return status ? status : neph_march_split_run(&shade->cut, submit_shade_run, &work, diag);
}

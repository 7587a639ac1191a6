/* SPDX-License-Identifier: MIT */
#include "renderer/sky/device.h"

#include "renderer/sky/tables.h"

#include <math.h>
#include <stdio.h>

static const uint32_t picture_spirv[] = {
#include "shaders/sky_picture.comp.inc"
};

enum { local_size = 64, PART_PIXELS = 1 << 20, BUFFERS = NEPH_SKY_BUFFERS + 1 };

struct work {
    struct neph_vulkan *vulkan;
    struct neph_sky_tables tables;
    struct neph_sky_times times;
    const struct neph_kernel *kernel;
    struct neph_buffer pixels, readback;
    size_t pixel_count;
    struct neph_sky_stats stats;
};

/* --- what can be rendered --------------------------------------------------------------------- */

bool neph_sky_device_can(const struct neph_scene *scene, const struct neph_sky_params *params,
                         char *reason, size_t reason_size)
{
    struct neph_sky_air air;
    if (!neph_sky_air_of(scene, &air, reason, reason_size))
        return false;
    const char *obstacle = scene->solid_count > 1 ? "solids beside the ground, on a device"
                                                  : neph_sky_tables_obstacle(scene, &air, params);
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return !obstacle;
}

/* --- a picture -------------------------------------------------------------------------------- */

struct layers {
    float *radiance[3], *volume[3], *transmittance[3], *depth;
};

static enum neph_status add_layers(struct neph_image *image, struct layers *layers,
                                   struct neph_diag *diag)
{
    enum neph_status status = neph_image_add_rgb(image, NULL, layers->radiance, diag);
    if (!status)
        status = neph_image_add_rgb(image, "volume", layers->volume, diag);
    if (!status)
        status = neph_image_add_rgb(image, "transmittance", layers->transmittance, diag);
    if (!status)
        status = neph_image_add_channel(image, "Z", &layers->depth, diag);
    return status;
}

static void take_part(const struct neph_gpu_sky_pixel *pixels, size_t first, size_t count,
                      const struct layers *layers)
{
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            layers->radiance[c][first + i] = pixels[i].radiance[c];
            layers->volume[c][first + i] = pixels[i].volume[c];
            layers->transmittance[c][first + i] = pixels[i].transmittance[c];
        }
        const float depth_m = pixels[i].radiance[3];
        layers->depth[first + i] = depth_m < NEPH_GPU_FAR_M ? depth_m : INFINITY;
    }
}

static size_t part_pixels(const struct work *work)
{
    return work->pixel_count < PART_PIXELS ? work->pixel_count : PART_PIXELS;
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    const struct neph_kernel_params params = {.name = "sky_picture",
                                              .spirv = picture_spirv,
                                              .spirv_size_bytes = sizeof(picture_spirv),
                                              .buffer_count = BUFFERS,
                                              .push_size_bytes = sizeof(struct neph_gpu_sky_part)};
    const size_t bytes = part_pixels(work) * sizeof(struct neph_gpu_sky_pixel);
    enum neph_status status = neph_buffer_create(work->vulkan, NEPH_BUFFER_DEVICE, bytes,
                                                 "sky pixels", &work->pixels, diag);
    if (!status)
        status = neph_buffer_create(work->vulkan, NEPH_BUFFER_READBACK, bytes, "sky readback",
                                    &work->readback, diag);
    return status ? status : neph_kernel_get(work->vulkan, &params, &work->kernel, diag);
}

static enum neph_status show_part(struct work *work, struct neph_gpu_sky_part part,
                                  struct neph_diag *diag)
{
    double gpu_s = 0.0;
    const struct neph_dispatch dispatch = {
        .buffers = {&work->tables.told, &work->tables.nodes, &work->pixels},
        .push = &part,
        .group_count = (part.pixel_count + local_size - 1) / local_size,
        .copy_from = &work->pixels,
        .copy_to = &work->readback,
        .copy_size_bytes = part.pixel_count * sizeof(struct neph_gpu_sky_pixel),
    };
    const enum neph_status status = neph_kernel_run(work->vulkan, work->kernel, &dispatch, &gpu_s,
                                                    diag);
    work->stats.picture_s += gpu_s;
    return status;
}

static enum neph_status show(struct work *work, struct neph_image *image, struct neph_diag *diag)
{
    struct layers layers;
    enum neph_status status = add_layers(image, &layers, diag);
    for (size_t first = 0; first < work->pixel_count && !status; first += PART_PIXELS) {
        const size_t left = work->pixel_count - first;
        const size_t count = left < PART_PIXELS ? left : PART_PIXELS;
        status = show_part(work, (struct neph_gpu_sky_part){(uint32_t)first, (uint32_t)count},
                           diag);
        if (!status)
            take_part(work->readback.mapped, first, count, &layers);
    }
    return status;
}

static void finish(struct work *work)
{
    neph_buffer_destroy(work->vulkan, &work->readback);
    neph_buffer_destroy(work->vulkan, &work->pixels);
    neph_sky_tables_destroy(&work->tables); /* waits: times are told then */
    work->stats.tables_s = work->times.air_s;
    work->stats.view_s = work->times.view_s;
}

enum neph_status neph_sky_device_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_sky_params *params, double frame,
                                        int width_px, int height_px, struct neph_image **image,
                                        struct neph_sky_stats *stats, struct neph_diag *diag)
{
    char reason[200];
    struct neph_image *made = NULL;
    struct neph_sky_air air;
    const struct neph_sky_look look = {
        .scene = scene, .frame = frame, .width_px = width_px, .height_px = height_px};
    struct work work = {.vulkan = vulkan, .pixel_count = (size_t)width_px * (size_t)height_px};
    if (!neph_sky_device_can(scene, params, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "engine sky has nothing for %s", reason);
    neph_sky_air_of(scene, &air, reason, sizeof(reason));
    enum neph_status status = neph_image_create(width_px, height_px, &made, diag);
    if (!status)
        status = neph_sky_tables_create(vulkan, &air, scene->scattering, params, &work.tables,
                                        diag);
    if (!status)
        status = prepare(&work, diag);
    if (!status)
        status = neph_sky_tables_look(&work.tables, &look, &work.times, diag);
    if (!status)
        status = show(&work, made, diag);
    finish(&work);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *stats = work.stats;
    *image = made;
    return NEPH_OK;
}

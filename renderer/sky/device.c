/* SPDX-License-Identifier: MIT */
#include "renderer/sky/device.h"

#include "renderer/sky/tables.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const uint32_t picture_code[] = {
#include "shaders/sky_picture.comp.inc"
};

enum { local_size = 64, PART_PIXELS = 1 << 20, BUFFERS = NEPH_SKY_BUFFERS + 1 };

struct neph_sky_pictures {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_sky_tables tables;
    const struct neph_kernel *kernel;
    struct neph_buffer pixels, readback;
    int width_px, height_px;
    struct neph_in_flight flight;
    struct neph_sky_stats flights[NEPH_IN_FLIGHT_FRAMES];
};

/* --- supported scenes ------------------------------------------------------------------------- */

bool neph_sky_device_can(const struct neph_scene *scene, const struct neph_sky_params *params,
                         char *reason, size_t reason_size)
{
    struct neph_sky_air air;
    if (!neph_sky_air_of(scene, &air, reason, reason_size))
        return false;
    const char *obstacle = scene->solid_count > 1
                               ? "solids other than the ground, on a device: engine march supports "
                                 "them with sky=tables, this one with on=cpu"
                               : neph_sky_tables_obstacle(scene, &air, params);
    if (obstacle)
        snprintf(reason, reason_size, "%s", obstacle);
    return !obstacle;
}

/* --- layers ----------------------------------------------------------------------------------- */

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

/* --- creation --------------------------------------------------------------------------------- */

static size_t pixel_count(const struct neph_sky_pictures *pictures)
{
    return (size_t)pictures->width_px * (size_t)pictures->height_px;
}

static size_t part_pixels(const struct neph_sky_pictures *pictures)
{
    return pixel_count(pictures) < PART_PIXELS ? pixel_count(pictures) : PART_PIXELS;
}

static enum neph_status prepare(struct neph_sky_pictures *pictures, struct neph_diag *diag)
{
    struct neph_kernel_params params = {.name = "sky_picture",
                                        .code = picture_code,
                                        .code_bytes = sizeof(picture_code),
                                        .buffer_count = BUFFERS,
                                        .push_size_bytes = sizeof(struct neph_gpu_sky_part)};
    neph_sky_constants(&pictures->tables, &params);
    const size_t bytes = part_pixels(pictures) * sizeof(struct neph_gpu_sky_pixel);
    const struct neph_buffer_row rows[] = {
        {&pictures->pixels, NEPH_BUFFER_DEVICE, bytes, "sky pixels"},
        {&pictures->readback, NEPH_BUFFER_READBACK, bytes, "sky readback"},
    };
    const enum neph_status status = neph_buffers_create(pictures->vulkan, rows, 2, diag);
    return status ? status : neph_kernel_get(pictures->vulkan, &params, &pictures->kernel, diag);
}

enum neph_status neph_sky_pictures_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_sky_params *params, int width_px,
                                          int height_px, struct neph_sky_pictures **pictures,
                                          struct neph_diag *diag)
{
    char reason[200];
    struct neph_sky_air air;
    if (!neph_sky_device_can(scene, params, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "engine sky does not support %s", reason);
    neph_sky_air_of(scene, &air, reason, sizeof(reason));
    struct neph_sky_pictures *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->vulkan = vulkan;
    made->width_px = width_px;
    made->height_px = height_px;
    enum neph_status status = neph_sky_tables_create(vulkan, &air, scene->scattering, params,
                                                     &made->tables, diag);
    if (!status)
        status = prepare(made, diag);
    if (status)
        neph_sky_pictures_destroy(made);
    else
        *pictures = made;
    return status;
}

void neph_sky_pictures_destroy(struct neph_sky_pictures *pictures)
{
    if (!pictures)
        return;
    neph_buffer_destroy(pictures->vulkan, &pictures->readback);
    neph_buffer_destroy(pictures->vulkan, &pictures->pixels);
    neph_sky_tables_destroy(&pictures->tables);
    free(pictures);
}

/* --- a frame ---------------------------------------------------------------------------------- */

static enum neph_status send_part(struct neph_sky_pictures *pictures, struct neph_gpu_sky_part part,
                                  double *gpu_s, struct neph_diag *diag)
{
    const struct neph_dispatch dispatch = {
        .buffers = {&pictures->tables.told, &pictures->tables.nodes, &pictures->pixels},
        .push = &part,
        .group_count = (part.pixel_count + local_size - 1) / local_size,
    };
    return neph_dispatch_send(pictures->vulkan, pictures->kernel, &dispatch, "the sky", gpu_s,
                              diag);
}

/* Submit all parts, and copy them into the layers of an image if there is one. */
static enum neph_status show(struct neph_sky_pictures *pictures, const struct layers *layers,
                             double *gpu_s, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t first = 0; first < pixel_count(pictures) && !status; first += PART_PIXELS) {
        const size_t left = pixel_count(pictures) - first;
        const size_t count = left < PART_PIXELS ? left : PART_PIXELS;
        status = send_part(pictures, (struct neph_gpu_sky_part){(uint32_t)first, (uint32_t)count},
                           gpu_s, diag);
        if (!status && layers)
            status = neph_buffer_download(pictures->vulkan, &pictures->pixels, &pictures->readback,
                                          count * sizeof(struct neph_gpu_sky_pixel), diag);
        if (!status && layers)
            take_part(pictures->readback.mapped, first, count, layers);
    }
    return status;
}

static enum neph_status send_picture(struct neph_sky_pictures *pictures,
                                     const struct neph_scene *scene, double frame,
                                     const struct layers *layers, struct neph_sky_stats **stats,
                                     struct neph_diag *diag)
{
    const struct neph_sky_look look = {.scene = scene,
                                       .frame = frame,
                                       .width_px = pictures->width_px,
                                       .height_px = pictures->height_px};
    int slot;
    enum neph_status status = neph_in_flight_begin(pictures->vulkan, &pictures->flight, &slot,
                                                   diag);
    if (status)
        return status;
    *stats = &pictures->flights[slot];
    **stats = (struct neph_sky_stats){.picture_s = 0.0};
    status = neph_sky_tables_look(&pictures->tables, &look, &(*stats)->tables, diag);
    if (!status)
        status = show(pictures, layers, &(*stats)->picture_s, diag);
    if (!status)
        status = neph_vulkan_check(pictures->vulkan, diag);
    if (!status)
        neph_in_flight_end(pictures->vulkan, &pictures->flight);
    return status;
}

enum neph_status neph_sky_pictures_frame(struct neph_sky_pictures *pictures,
                                         const struct neph_scene *scene, double frame,
                                         struct neph_image **image, struct neph_sky_stats *stats,
                                         struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    struct neph_sky_stats *own;
    struct layers layers;
    if (!image)
        return send_picture(pictures, scene, frame, NULL, &own, diag);
    enum neph_status status = neph_image_create(pictures->width_px, pictures->height_px, &made,
                                                diag);
    if (!status)
        status = add_layers(made, &layers, diag);
    if (!status)
        status = send_picture(pictures, scene, frame, &layers, &own, diag);
    if (!status)
        status = neph_in_flight_land(pictures->vulkan, &pictures->flight, diag);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *stats = *own;
    *image = made;
    return NEPH_OK;
}

enum neph_status neph_sky_pictures_home(struct neph_sky_pictures *pictures,
                                        struct neph_sky_stats *stats, struct neph_diag *diag)
{
    int slot;
    const enum neph_status status = neph_in_flight_home(pictures->vulkan, &pictures->flight, &slot,
                                                        diag);
    if (!status)
        *stats = pictures->flights[slot];
    return status;
}

/* SPDX-License-Identifier: MIT */
#include "renderer/tracer_parts.h"

#include <stdlib.h>
#include <string.h>

static const size_t pixel_bytes = sizeof(struct neph_gpu_tracer_pixel);

static size_t choose_part(const struct neph_vulkan *vulkan, size_t chunk_pixels, size_t most_pixels)
{
    const size_t allowed = vulkan->limits.maxStorageBufferRange / pixel_bytes;
    const size_t most = most_pixels > 0 && most_pixels < allowed ? most_pixels : allowed;
    return most > chunk_pixels ? most / chunk_pixels * chunk_pixels : chunk_pixels;
}

static size_t count_part_pixels(const struct neph_tracer_parts *parts, int part)
{
    const size_t left = parts->pixel_count - (size_t)part * parts->part_pixels;
    return left < parts->part_pixels ? left : parts->part_pixels;
}

enum neph_status neph_tracer_parts_create(const struct neph_vulkan *vulkan, size_t pixel_count,
                                          size_t chunk_pixels, size_t most_pixels,
                                          struct neph_tracer_parts *parts, struct neph_diag *diag)
{
    parts->pixel_count = pixel_count;
    parts->part_pixels = choose_part(vulkan, chunk_pixels, most_pixels);
    parts->count = (int)((pixel_count + parts->part_pixels - 1) / parts->part_pixels);
    parts->parts = calloc((size_t)parts->count, sizeof(*parts->parts));
    enum neph_status status = parts->parts ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; !status && i < parts->count; i++)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE,
                                    count_part_pixels(parts, i) * pixel_bytes, "tracer pixels",
                                    &parts->parts[i], diag);
    if (!status)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_READBACK,
                                    count_part_pixels(parts, 0) * pixel_bytes,
                                    "tracer pixels readback", &parts->readback, diag);
    return status;
}

void neph_tracer_parts_destroy(const struct neph_vulkan *vulkan, struct neph_tracer_parts *parts)
{
    for (int i = 0; parts->parts && i < parts->count; i++)
        neph_buffer_destroy(vulkan, &parts->parts[i]);
    neph_buffer_destroy(vulkan, &parts->readback);
    free(parts->parts);
    *parts = (struct neph_tracer_parts){.count = 0};
}

const struct neph_buffer *neph_tracer_find_part(const struct neph_tracer_parts *parts, size_t pixel,
                                                uint32_t *first_pixel)
{
    const size_t part = pixel / parts->part_pixels;
    *first_pixel = (uint32_t)(part * parts->part_pixels);
    return &parts->parts[part];
}

enum neph_status neph_tracer_parts_upload(const struct neph_vulkan *vulkan,
                                          const struct neph_tracer_parts *parts,
                                          const struct neph_gpu_tracer_pixel *pixels,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; !status && i < parts->count; i++)
        status = neph_buffer_upload(vulkan, &parts->parts[i], 0,
                                    pixels + (size_t)i * parts->part_pixels,
                                    count_part_pixels(parts, i) * pixel_bytes, diag);
    return status;
}

enum neph_status neph_tracer_parts_download(const struct neph_vulkan *vulkan,
                                            const struct neph_tracer_parts *parts,
                                            struct neph_gpu_tracer_pixel *pixels,
                                            struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; !status && i < parts->count; i++) {
        const size_t bytes = count_part_pixels(parts, i) * pixel_bytes;
        status = neph_buffer_download(vulkan, &parts->parts[i], &parts->readback, bytes, diag);
        if (!status)
            memcpy(pixels + (size_t)i * parts->part_pixels, parts->readback.mapped, bytes);
    }
    return status;
}

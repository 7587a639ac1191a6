/* SPDX-License-Identifier: MIT
 *
 * The path tracer's sums on the device. A kernel cannot bind more of a buffer than the device
 * allows (lavapipe: 128 MiB), so a large frame is divided into several buffers. Private to
 * renderer/.
 */
#ifndef NEPH_RENDERER_TRACER_PARTS_H
#define NEPH_RENDERER_TRACER_PARTS_H

#include "renderer/compute.h"
#include "shaders/structs.h"

struct neph_tracer_parts {
    size_t pixel_count, part_pixels; /* pixels of the frame; of each part except the last */
    int count;
    struct neph_buffer *parts; /* owned */
    struct neph_buffer readback;
};

/* For a frame that is processed in chunks: a chunk never spans two parts. `most_pixels`: limit of a
 * part; 0: the device's. Zero-initialise `parts`; free with _destroy whatever the status. */
enum neph_status neph_tracer_parts_create(const struct neph_vulkan *vulkan, size_t pixel_count,
                                          size_t chunk_pixels, size_t most_pixels,
                                          struct neph_tracer_parts *parts, struct neph_diag *diag);

void neph_tracer_parts_destroy(const struct neph_vulkan *vulkan, struct neph_tracer_parts *parts);

/* The part with a pixel; `*first_pixel` receives the index of the part's first pixel. */
const struct neph_buffer *neph_tracer_find_part(const struct neph_tracer_parts *parts, size_t pixel,
                                                uint32_t *first_pixel);

/* Copy all pixels of the frame from and to the CPU; both wait. */
enum neph_status neph_tracer_parts_upload(const struct neph_vulkan *vulkan,
                                          const struct neph_tracer_parts *parts,
                                          const struct neph_gpu_tracer_pixel *pixels,
                                          struct neph_diag *diag);
enum neph_status neph_tracer_parts_download(const struct neph_vulkan *vulkan,
                                            const struct neph_tracer_parts *parts,
                                            struct neph_gpu_tracer_pixel *pixels,
                                            struct neph_diag *diag);

#endif

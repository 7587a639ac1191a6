/* SPDX-License-Identifier: MIT
 *
 * What the path tracer's samples have come to: sums in double over all batches, their error, and
 * the frame that follows from them. Private to renderer/.
 */
#ifndef NEPH_RENDERER_TRACER_SUMS_H
#define NEPH_RENDERER_TRACER_SUMS_H

#include "base/image.h"
#include "shaders/structs.h"

#include <stdbool.h>
#include <stddef.h>

/* Values before the pixels. */
enum {
    NEPH_SUMS_SAMPLES,
    NEPH_SUMS_COLLISIONS,
    NEPH_SUMS_LOOKUPS,
    NEPH_SUMS_CLOSED_FORMS,
    NEPH_SUMS_HEAD
};

/* One array, as it goes to the checkpoint. */
struct neph_tracer_sums {
    double *values; /* as many as neph_tracer_sums_count() says */
    size_t pixel_count;
};

size_t neph_tracer_sums_count(const struct neph_tracer_sums *sums);

/* Add a batch of one pixel. */
void neph_tracer_sums_add(struct neph_tracer_sums *sums, size_t index,
                          const struct neph_gpu_tracer_pixel *pixel);

/* Rms standard error of the means over rms radiance of volume light; +inf where nothing was seen
 * yet although media scatter light (`is_lit`). */
double neph_tracer_sums_error(const struct neph_tracer_sums *sums, bool is_lit);

/* The first floats of struct neph_gpu_tracer_pixel, which need no chance. */
enum { NEPH_TRACER_VIEW_FLOATS = 8 };

/* `view_light`: NEPH_TRACER_VIEW_FLOATS of each pixel. `is_open`: transmittances are sums, too. */
enum neph_status neph_tracer_sums_frame(const struct neph_tracer_sums *sums,
                                        const float *view_light, bool is_open, int width_px,
                                        int height_px, struct neph_image **frame,
                                        struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * What the path tracer's samples have come to: the sums that the device keeps, each a float32 and
 * its rounding error, their error, and the frame that follows from them. Private to renderer/.
 */
#ifndef NEPH_RENDERER_TRACER_SUMS_H
#define NEPH_RENDERER_TRACER_SUMS_H

#include "base/image.h"
#include "shaders/structs.h"

#include <stdbool.h>
#include <stddef.h>

/* What is counted of all pixels together. */
enum {
    NEPH_SUMS_SAMPLES, /* of each pixel */
    NEPH_SUMS_COLLISIONS,
    NEPH_SUMS_LOOKUPS,
    NEPH_SUMS_CLOSED_FORMS,
    NEPH_SUMS_HEAD
};

struct neph_tracer_sums {
    double head[NEPH_SUMS_HEAD];
    struct neph_gpu_tracer_pixel *pixels; /* owned; of the whole frame, as the device has them */
    size_t pixel_count;
    bool is_sobol; /* samples are of two sequences, and the sums of their differences are kept */
};

/* Numbers of a checkpoint. */
size_t neph_tracer_sums_count(const struct neph_tracer_sums *sums);

/* To and from a checkpoint: every bit of the sums. */
void neph_tracer_sums_save(const struct neph_tracer_sums *sums, double *values);
void neph_tracer_sums_load(struct neph_tracer_sums *sums, const double *values);

/* Rms standard error of the means over rms radiance of volume light; +inf where nothing was seen
 * yet although media scatter light (`is_lit`). */
double neph_tracer_sums_error(const struct neph_tracer_sums *sums, bool is_lit);

/* `is_open`: transmittances are sums, too. */
enum neph_status neph_tracer_sums_frame(const struct neph_tracer_sums *sums, bool is_open,
                                        int width_px, int height_px, struct neph_image **frame,
                                        struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The path tracer's results: sums kept by the device, each a float32 and its rounding error, their
 * standard error, and the frame computed from them. Private to renderer/.
 */
#ifndef NEPH_RENDERER_TRACER_SUMS_H
#define NEPH_RENDERER_TRACER_SUMS_H

#include "base/doubt.h"
#include "shaders/structs.h"

#include <stdbool.h>
#include <stddef.h>

/* Counters over all pixels. */
enum {
    NEPH_SUMS_SAMPLES, /* samples per pixel */
    NEPH_SUMS_COLLISIONS,
    NEPH_SUMS_LOOKUPS,
    NEPH_SUMS_CLOSED_FORMS,
    NEPH_SUMS_HEAD
};

struct neph_tracer_sums {
    double head[NEPH_SUMS_HEAD];
    struct neph_gpu_tracer_pixel *pixels; /* owned; the whole frame, in the device's layout */
    size_t pixel_count;
    bool is_sobol;      /* two sequences of samples; the sums of their differences are kept */
    double noise_scale; /* factor of the squared differences whose squares are summed */
};

/* Number of values in a checkpoint. */
size_t neph_tracer_sums_count(const struct neph_tracer_sums *sums);

/* To and from the values of a checkpoint, exact to the bit. */
void neph_tracer_sums_save(const struct neph_tracer_sums *sums, double *values);
void neph_tracer_sums_load(struct neph_tracer_sums *sums, const double *values);

/* Rms standard error of the means over rms radiance of volume light; +inf while no volume light was
 * sampled although media scatter light (`is_lit`). */
double neph_tracer_sums_error(const struct neph_tracer_sums *sums, bool is_lit);

/* Whether the variances of the means are to be trusted. */
struct neph_doubt neph_tracer_sums_doubt(const struct neph_tracer_sums *sums);

/* Compute the frame. `is_open`: transmittances are sums as well. */
enum neph_status neph_tracer_sums_frame(const struct neph_tracer_sums *sums, bool is_open,
                                        int width_px, int height_px, struct neph_image **frame,
                                        struct neph_diag *diag);

#endif

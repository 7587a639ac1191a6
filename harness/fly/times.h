/* SPDX-License-Identifier: MIT
 *
 * Times of the last frames and of their passes.
 */
#ifndef NEPH_HARNESS_FLY_TIMES_H
#define NEPH_HARNESS_FLY_TIMES_H

#include "base/image.h"

enum { NEPH_FLY_TIMES_MAX = 4096, NEPH_FLY_PASSES_MAX = 32 };

/* The times of the last NEPH_FLY_TIMES_MAX frames. */
struct neph_fly_times {
    double seconds[NEPH_FLY_TIMES_MAX];
    int count; /* of all frames added so far */
};

/* Add a time; a value that is not finite means "not measured" and is left out. */
void neph_fly_times_add(struct neph_fly_times *times, double seconds);

/* The median; NaN: no times. */
double neph_fly_times_median_s(const struct neph_fly_times *times);

/* Times of the passes of one engine: exponential averages with weight 1/8 for the newest frame.
 * Start from {0}, and again after a change of engine. */
struct neph_fly_passes {
    int count;
    struct {
        char name[NEPH_IMAGE_NAME_MAX];
        double mean_s;
    } passes[NEPH_FLY_PASSES_MAX];
};

/* Read the times from a frame's attributes "neph.stats.NAME_gpu_ms". */
void neph_fly_passes_add_frame(struct neph_fly_passes *passes, const struct neph_image *frame);

#endif

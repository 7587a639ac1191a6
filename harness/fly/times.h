/* SPDX-License-Identifier: MIT
 *
 * How long frames take, and each of their passes.
 */
#ifndef NEPH_HARNESS_FLY_TIMES_H
#define NEPH_HARNESS_FLY_TIMES_H

#include "base/image.h"

enum { NEPH_FLY_TIMES_MAX = 4096, NEPH_FLY_PASSES_MAX = 32 };

/* The last NEPH_FLY_TIMES_MAX of them. */
struct neph_fly_times {
    double seconds[NEPH_FLY_TIMES_MAX];
    int count; /* since the start, without end */
};

/* Not finite: not measured, and left out. */
void neph_fly_times_add(struct neph_fly_times *times, double seconds);

/* NaN: there is none. */
double neph_fly_times_median_s(const struct neph_fly_times *times);

/* The passes of the frames of one engine, each a mean that forgets with 1/8 a frame. Start from
 * {0}, and again with another engine. */
struct neph_fly_passes {
    int count;
    struct {
        char name[NEPH_IMAGE_NAME_MAX];
        double mean_s;
    } passes[NEPH_FLY_PASSES_MAX];
};

/* By the attributes "neph.stats.NAME_gpu_ms" of a frame. */
void neph_fly_passes_take(struct neph_fly_passes *passes, const struct neph_image *frame);

#endif

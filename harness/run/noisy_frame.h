/* SPDX-License-Identifier: MIT
 *
 * Frames of an engine with noise, by samples and seed, and means over their pixels and channels of
 * which noise^2, error^2 and bias^2 are made (harness/run/benchmark.h).
 */
#ifndef NEPH_HARNESS_RUN_NOISY_FRAME_H
#define NEPH_HARNESS_RUN_NOISY_FRAME_H

#include "harness/run/job.h"

enum { NEPH_NOISE_SEEDS = 2 }; /* that a noise is measured between */

struct neph_noisy_frame {
    struct neph_image *image;
    const float *planes[3];
    double render_s;
};

/* The job with another number of samples and another seed. Finish the frame, failed or not. */
enum neph_status neph_noisy_render(const struct neph_job *of, int samples, uint64_t seed,
                                   struct neph_noisy_frame *frame, struct neph_diag *diag);

void neph_noisy_finish(struct neph_noisy_frame *frame);

/* Mean over pixels and channels of (a - r) (b - s); frames of NULL are black, but for a and b. */
double neph_noisy_cross(const struct neph_noisy_frame *a, const struct neph_noisy_frame *r,
                        const struct neph_noisy_frame *b, const struct neph_noisy_frame *s);

/* Half the mean of (a - b)^2: the squared noise of one of two seeds. */
double neph_noisy_noise2(const struct neph_noisy_frame frames[NEPH_NOISE_SEEDS]);

/* The mean radiance. */
double neph_noisy_mean(const struct neph_noisy_frame *frame);

#endif

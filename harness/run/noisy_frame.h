/* SPDX-License-Identifier: MIT
 *
 * Frames with noise, by samples and seed, and the means over pixels and channels that noise^2,
 * error^2 and bias^2 are computed from (harness/run/benchmark.h).
 */
#ifndef NEPH_HARNESS_RUN_NOISY_FRAME_H
#define NEPH_HARNESS_RUN_NOISY_FRAME_H

#include "harness/run/job.h"

enum { NEPH_NOISE_SEEDS = 2 }; /* seeds of a noise measurement */

struct neph_noisy_frame {
    struct neph_image *image;
    const float *planes[3];
    double render_s;
};

/* Renders the job with another number of samples and another seed. Call neph_noisy_finish() even
 * after an error. */
enum neph_status neph_noisy_render(const struct neph_job *of, int samples, uint64_t seed,
                                   struct neph_noisy_frame *frame, struct neph_diag *diag);

void neph_noisy_finish(struct neph_noisy_frame *frame);

/* Mean over pixels and channels of (a - r) (b - s). NULL for r or s: black. */
double neph_noisy_cross(const struct neph_noisy_frame *a, const struct neph_noisy_frame *r,
                        const struct neph_noisy_frame *b, const struct neph_noisy_frame *s);

/* Half the mean of (a - b)^2: the squared noise of one of the two frames. */
double neph_noisy_compute_noise2(const struct neph_noisy_frame frames[NEPH_NOISE_SEEDS]);

/* The mean radiance over pixels and channels. */
double neph_noisy_compute_mean(const struct neph_noisy_frame *frame);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The relative noise of a frame: the rms standard error of its pixels over the rms radiance.
 */
#ifndef NEPH_HARNESS_RUN_NOISE_H
#define NEPH_HARNESS_RUN_NOISE_H

#include "base/image.h"

/* From the frame's own variance layer; NaN when it has none. */
double neph_noise_from_variance(const struct neph_image *frame);

/* The noise of each of two frames of one job with different seeds: half the mean squared difference
 * is the variance of one frame. NaN when the frames have no common R G B. */
double neph_noise_from_two_seeds(const struct neph_image *a, const struct neph_image *b);

#endif

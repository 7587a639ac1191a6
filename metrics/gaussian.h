/* SPDX-License-Identifier: MIT
 *
 * Gaussian blur of a plane of pixels, in single precision.
 */
#ifndef NEPH_METRICS_GAUSSIAN_H
#define NEPH_METRICS_GAUSSIAN_H

#include "base/status.h"

/* Blur `plane`, width * height, in place. The taps reach to three standard deviations and sum to 1;
 * the image is mirrored at its borders. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_gaussian_blur(float *plane, int width_px, int height_px, double sigma_px,
                                    struct neph_diag *diag);

#endif

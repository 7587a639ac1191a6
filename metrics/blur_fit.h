/* SPDX-License-Identifier: MIT
 *
 * The blur between two versions of the same planes of pixels.
 */
#ifndef NEPH_METRICS_BLUR_FIT_H
#define NEPH_METRICS_BLUR_FIT_H

#include "base/status.h"

/* The largest blur that is searched [px]. */
#define NEPH_BLUR_FIT_MOST_PX 1.5

/* Planes of width * height pixels, two of each frame. */
struct neph_blur_fit {
    const float *const *sharp, *const *blurred;
    int frame_count, width_px, height_px;
};

/* Finds the standard deviation [px] of the Gaussian (gaussian.h) that takes `sharp` to `blurred`
 * with the least sum of squared differences over all frames, in steps of 0.001; 0: no blur has
 * less. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_blur_fit_find(const struct neph_blur_fit *fit, double *sigma_px,
                                    struct neph_diag *diag);

#endif

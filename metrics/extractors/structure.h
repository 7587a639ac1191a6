/* SPDX-License-Identifier: MIT
 *
 * Structural similarity in a sliding window, as libvmaf defines it (Wang, Bovik, Sheikh and
 * Simoncelli, IEEE Transactions on Image Processing 13, 2004, equations 6 to 13). The window is
 * Gaussian, of 11x11 px, with a standard deviation of 1.5 px and the sum 1, and counts where it
 * lies wholly inside; population covariance; K1 = 0.01, K2 = 0.03, C3 = C2 / 2. The weights are
 * those of the formula, in double precision. libvmaf itself has them to six digits, which sum to
 * 1.000002, and works in single precision: evaluated in its way, the frames of the tests have means
 * lower by 7e-5 to 3e-4.
 */
#ifndef NEPH_METRICS_EXTRACTORS_STRUCTURE_H
#define NEPH_METRICS_EXTRACTORS_STRUCTURE_H

#include "base/status.h"

enum {
    NEPH_STRUCTURE_WINDOW_PX = 11,
    NEPH_STRUCTURE_MARGIN_PX = NEPH_STRUCTURE_WINDOW_PX / 2,
};

/* Means over all windows of the three factors of SSIM. */
struct neph_structure {
    double luminance, contrast, structure;
};

/* Compare two images of width x height code values, both sides at least 11; `peak` is the L of the
 * constants. `map` (may be NULL) has the size of the images and receives the product of the
 * factors at the centres of the windows; its margin of 5 px is not touched. The same bits on any
 * number of threads. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_structure_compare(const double *reference, const double *test, int width_px,
                                        int height_px, double peak, double *map,
                                        struct neph_structure *means, struct neph_diag *diag);

#endif

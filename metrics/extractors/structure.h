/* SPDX-License-Identifier: MIT
 *
 * Structural similarity in a sliding window, as libvmaf defines it (Wang, Bovik, Sheikh and
 * Simoncelli, IEEE Transactions on Image Processing 13, 2004, equations 6 to 13). The window is
 * Gaussian, 11x11 px, with a standard deviation of 1.5 px and sum 1; only windows inside the image
 * count; population covariance; K1 = 0.01, K2 = 0.03, C3 = C2 / 2. The weights follow the formula
 * in double precision. libvmaf has them to six digits, with the sum 1.000002, and works in single
 * precision: evaluated that way, the means of the test frames are lower by 7e-5 to 3e-4.
 */
#ifndef NEPH_METRICS_EXTRACTORS_STRUCTURE_H
#define NEPH_METRICS_EXTRACTORS_STRUCTURE_H

#include "base/status.h"

enum {
    NEPH_STRUCTURE_WINDOW_PX = 11,
    NEPH_STRUCTURE_MARGIN_PX = NEPH_STRUCTURE_WINDOW_PX / 2,
};

/* The weights of the window. The uniform one has 49 equal weights and sample covariance, as
 * scikit-image's default; its pixels beyond 7x7 have the weight 0. */
enum neph_structure_window { NEPH_STRUCTURE_GAUSSIAN, NEPH_STRUCTURE_UNIFORM_7 };

/* Means over all windows of the three factors of SSIM. */
struct neph_structure {
    double luminance, contrast, structure;
};

/* Compare two images of width x height code values, both sides at least 11; `peak` is L in the
 * constants. `map` (may be NULL) has the size of the images and receives the product of the factors
 * at the window centres; its margin of 5 px stays unchanged. The bits do not depend on the number
 * of threads. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_structure_compare(const double *reference, const double *test,
                                        enum neph_structure_window window, int width_px,
                                        int height_px, double peak, double *map,
                                        struct neph_structure *means, struct neph_diag *diag);

#endif

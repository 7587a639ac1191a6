/* SPDX-License-Identifier: MIT
 *
 * The place of the largest error of radiance in a comparison: max_abs of the extractor `error`.
 */
#ifndef NEPH_METRICS_LARGEST_ERROR_H
#define NEPH_METRICS_LARGEST_ERROR_H

#include "base/image.h"

#include <stdbool.h>

/* Start from {0}. */
struct neph_largest_error {
    bool is_known; /* false: no frame has an error */
    int frame;     /* index of the measured frame, the first with this error */
    int x_px, y_px;
    char channel; /* 'R', 'G' or 'B' */
    double reference, test;
};

/* Look for a larger error in a frame. Frames without radiance are skipped. */
void neph_largest_error_add(struct neph_largest_error *largest, const struct neph_image *reference,
                            const struct neph_image *test, int frame);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The histogram of the signed relative error of radiance, over all pixels and channels of all
 * frames: e = (test - reference) / max(|reference|, 1e-4 S), S the mean luminance of the frame's
 * reference (the |e| of max_rel of the extractor `error`).
 */
#ifndef NEPH_METRICS_ERROR_HISTOGRAM_H
#define NEPH_METRICS_ERROR_HISTOGRAM_H

#include "base/image.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Two edges a decade from 1e-4 to 10, of both signs: bin i has edge i <= e < edge i + 1. The bin in
 * the middle, below 1e-4 of both signs, has the equal samples. */
enum { NEPH_HISTOGRAM_EDGES = 22, NEPH_HISTOGRAM_BINS = NEPH_HISTOGRAM_EDGES - 1 };

/* Start from {0}. */
struct neph_error_histogram {
    uint64_t at_least[NEPH_HISTOGRAM_EDGES]; /* samples with e >= edge */
    uint64_t count;                          /* samples with a finite reference and test */
    uint64_t not_finite;                     /* other samples */
};

/* Edge i, 0 .. NEPH_HISTOGRAM_EDGES - 1, in ascending order. */
double neph_histogram_edge(int i);

/* The number of samples from edge `first` to before edge `last`. first = -1: from -infinity; last =
 * NEPH_HISTOGRAM_EDGES: to infinity. */
uint64_t neph_histogram_count(const struct neph_error_histogram *histogram, int first, int last);

/* Add a frame. Frames without radiance are skipped. A reference without light has S = 0: errors of
 * its black samples are infinite. The counts do not depend on the number of threads.
 * NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_histogram_add(struct neph_error_histogram *histogram,
                                    const struct neph_image *reference,
                                    const struct neph_image *test, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Two tests against the same reference, frame by frame: is the one better than the other?
 */
#ifndef NEPH_HARNESS_VERSUS_H
#define NEPH_HARNESS_VERSUS_H

#include "base/status.h"
#include "harness/json.h"

/* From the measurements of two runs of neph_comparison_run() with the same frames: an array with an
 * object for each number that both have of each frame,
 *   "quantity", "metric", "mask", "unit"
 *   "difference"  mean of (first - second) over the frames, with "interval" (95 %, or null),
 *                 "interval_kind" and "n" as in measurements
 *   "p"           Student's t on the batches, "p_holm" corrected for all numbers of the array
 *   "p_sign"      exact sign test on the batches
 * (metrics/series.h), then with one for each number of the whole sequence alone, such as flicker:
 * "interval" and the three p are null there. NULL when memory is short. */
json_t *neph_versus(const json_t *first, const json_t *second, struct neph_diag *diag);

#endif

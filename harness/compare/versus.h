/* SPDX-License-Identifier: MIT
 *
 * Two tests against the same reference, frame by frame: is the one better than the other?
 */
#ifndef NEPH_HARNESS_COMPARE_VERSUS_H
#define NEPH_HARNESS_COMPARE_VERSUS_H

#include "harness/compare/comparison.h"
#include "harness/json.h"

/* One of the two: measurements of a run of neph_comparison_run(), all or some, and their draws. */
struct neph_versus_side {
    const json_t *numbers;
    const struct neph_measurements *drawn;
};

/* From two runs with the same frames: an array with an object for each number that both have of
 * each of several frames,
 *   "quantity", "metric", "mask", "unit"
 *   "difference"  mean of (first - second) over the frames, with "interval" (95 %, or null),
 *                 "interval_kind" and "n" as in measurements
 *   "p"           Student's t on the batches, "p_holm" corrected for all p of the array
 *   "p_sign"      exact sign test on the batches
 *   "because"     why there is no interval and no p: the three are null then
 * and then one for each number of the whole sequence alone, such as flicker, or of the only frame:
 * there interval and p are from paired draws of tiles, and "p_sign" is null (metrics/series.h).
 * NULL when memory is short. */
json_t *neph_versus(const struct neph_versus_side *first, const struct neph_versus_side *second,
                    struct neph_diag *diag);

#endif

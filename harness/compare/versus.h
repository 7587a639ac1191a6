/* SPDX-License-Identifier: MIT
 *
 * Two tests against the same reference, frame by frame: is the one better than the other?
 */
#ifndef NEPH_HARNESS_COMPARE_VERSUS_H
#define NEPH_HARNESS_COMPARE_VERSUS_H

#include "harness/compare/measure.h"

/* A number of one test less that of another. */
struct neph_difference {
    const struct neph_measurement *number; /* what of; borrowed of the first test */
    double value;                          /* mean of (first - second) over the frames */
    double first;                          /* mean of the first */
    int below, above;                      /* batches in which the first is lower, is higher */
    enum neph_interval_kind interval;      /* NONE: `because` says why */
    double low, high;                      /* 95 % */
    int n;                                 /* as in measurements */
    double p;                              /* Student's t on the batches; NaN without interval */
    double p_holm;                         /* corrected for all p of the list */
    double p_sign;                         /* exact sign test on the batches; NaN: there is none */
    char because[128];
};

/* Start from {0}; free with _finish. */
struct neph_differences {
    struct neph_difference *list; /* owned */
    int count;
};

void neph_differences_finish(struct neph_differences *differences);

/* From the numbers of two runs of neph_comparison_run() with the same frames, all or some, with
 * their draws: a difference for each number that both have of each of several frames, and then one
 * for each number of the whole sequence alone, such as flicker, or of the only frame: there
 * interval and p are from paired draws of tiles, and there is no p_sign (metrics/series.h). */
enum neph_status neph_versus(const struct neph_measurements *first,
                             const struct neph_measurements *second,
                             struct neph_differences *differences, struct neph_diag *diag);

/* An array of {"quantity", "metric", "mask", "unit", "difference", "interval", "interval_kind",
 * "n", "p", "p_sign", "because" (where there is no interval), "p_holm"}. */
json_t *neph_differences_json(const struct neph_differences *differences);

#endif

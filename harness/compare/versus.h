/* SPDX-License-Identifier: MIT
 *
 * Two tests against the same reference, frame by frame: is the one better than the other?
 */
#ifndef NEPH_HARNESS_COMPARE_VERSUS_H
#define NEPH_HARNESS_COMPARE_VERSUS_H

#include "harness/compare/measure.h"
#include "harness/compare/movement.h"

/* A number of one test less that of another. */
struct neph_difference {
    const struct neph_measurement *number; /* what of; borrowed of the first test */
    double value;                          /* mean of (first - second) over the frames */
    double first, second;                  /* mean of each */
    int frame_count;                       /* of a number that each frame has; else 0 */
    int frames_below, frames_above;        /* of them, in which the first is lower, is higher */
    enum neph_interval_kind interval;      /* NONE: `because` says why */
    double low, high;                      /* 95 % */
    int n;                                 /* as in measurements */
    double p;                              /* Student's t on the batches; NaN without interval */
    double p_holm;                         /* corrected for all p of the list */
    double p_sign;                         /* exact sign test on the batches; NaN: there is none */
    char because[128];
};

/* Two series over time (harness/compare/movement.h), paired value by value. */
struct neph_time_difference {
    int count;        /* of values; 0: there are none to pair */
    int below, above; /* of them, in which the first is lower, is higher */
    double value;     /* mean of (first - second) */
    double p;         /* from 64 frames on Student's t on batches of frames, else the sign test over
                         whole cycles */
};

/* Start from {0}; free with _finish. */
struct neph_differences {
    struct neph_difference *list; /* owned */
    int count;
    struct neph_time_difference frames, cycles; /* of the movement of frames, and of cycles */
};

/* Whether a metric is a place, an index or a count of frames: a difference of two such numbers says
 * nothing. */
bool neph_metric_is_place(const struct neph_metric *metric);

void neph_differences_finish(struct neph_differences *differences);

/* From the numbers of two runs of neph_comparison_run() with the same frames, all or some, with
 * their draws: a difference for each number that both have of each of several frames, and then one
 * for each number of the whole sequence, such as flicker, or of the only frame: there interval and
 * p are from paired draws of tiles, and there is no p_sign (metrics/series.h). */
enum neph_status neph_versus(const struct neph_measurements *first,
                             const struct neph_measurements *second,
                             struct neph_differences *differences, struct neph_diag *diag);

/* Pair the movement of both tests, too. Nothing is paired unless both have as many frames. */
enum neph_status neph_versus_add_movement(const struct neph_movement *first,
                                          const struct neph_movement *second,
                                          struct neph_differences *differences,
                                          struct neph_diag *diag);

/* An array of {"quantity", "metric", "mask", "unit", "test", "other", "difference", "interval",
 * "interval_kind", "n", "p", "p_sign", "because" (where there is no interval), "frames" (of a
 * number that each frame has: {"count", "lower", "higher"}), "p_holm"}. */
json_t *neph_differences_json(const struct neph_differences *differences);

/* {"frames": {"count", "lower", "higher", "difference", "p"}, "cycles": the same}; null where
 * nothing was paired. */
json_t *neph_time_differences_json(const struct neph_differences *differences);

#endif

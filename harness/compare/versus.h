/* SPDX-License-Identifier: MIT
 *
 * Paired comparison of two tests against the same reference, frame by frame.
 */
#ifndef NEPH_HARNESS_COMPARE_VERSUS_H
#define NEPH_HARNESS_COMPARE_VERSUS_H

#include "harness/compare/measure.h"
#include "harness/compare/movement.h"

/* A number of the first test minus the same number of the second. */
struct neph_difference {
    const struct neph_measurement *number; /* of the first test; borrowed */
    double value;                          /* mean of (first - second) over the frames */
    double first, second;                  /* mean of each test */
    int frame_count;                       /* for a number of each frame; otherwise 0 */
    int frames_below, frames_above;        /* frames in which the first is lower, or higher */
    enum neph_interval_kind interval;      /* NONE: see `because` */
    double low, high;                      /* 95 % */
    int n;                                 /* number of samples, as in measurements */
    double p;                              /* Student's t on the batches; NaN without an interval */
    double p_holm;                         /* corrected for all p-values of the list */
    double p_sign;                         /* exact sign test on the batches; NaN: none */
    char because[128];
};

/* Two series over time (harness/compare/movement.h), paired value by value. */
struct neph_time_difference {
    int count;        /* number of values; 0: no pairs */
    int below, above; /* values in which the first is lower, or higher */
    double value;     /* mean of (first - second) */
    double p;         /* from 64 frames: Student's t on batches of frames; below: sign test over
                         whole cycles */
};

/* Start from {0}; free with neph_differences_finish(). */
struct neph_differences {
    struct neph_difference *list; /* owned */
    int count;
    struct neph_time_difference frames, cycles; /* movement of frames, and of cycles */
};

/* True for a metric that is a position, an index or a count of frames: a difference of two such
 * numbers has no meaning. */
bool neph_metric_is_place(const struct neph_metric *metric);

void neph_differences_finish(struct neph_differences *differences);

/* Differences of the numbers of two runs of neph_comparison_run() with the same frames, and with
 * their draws. First a difference for each number that both have in each of several frames; then
 * one for each number of the whole sequence, such as flicker, or of the only frame. The latter have
 * interval and p from paired draws of tiles, and no p_sign (metrics/series.h). */
enum neph_status neph_versus(const struct neph_measurements *first,
                             const struct neph_measurements *second,
                             struct neph_differences *differences, struct neph_diag *diag);

/* Add the paired movement of both tests. Does nothing unless both have the same number of
 * frames. */
enum neph_status neph_versus_add_movement(const struct neph_movement *first,
                                          const struct neph_movement *second,
                                          struct neph_differences *differences,
                                          struct neph_diag *diag);

/* An array of {"quantity", "metric", "mask", "unit", "test", "other", "difference", "interval",
 * "interval_kind", "n", "p", "p_sign", "because" (without an interval), "frames" (for a number of
 * each frame: {"count", "lower", "higher"}), "p_holm"}. */
json_t *neph_differences_json(const struct neph_differences *differences);

/* {"frames": {"count", "lower", "higher", "difference", "p"}, "cycles": the same}; null without
 * pairs. */
json_t *neph_time_differences_json(const struct neph_differences *differences);

#endif

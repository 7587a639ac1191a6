/* SPDX-License-Identifier: MIT
 *
 * Means of series with one number per frame or per run, their uncertainty, and the comparison of
 * two series.
 *
 * Errors of neighbouring frames are correlated, so frames are not independent replicates. The
 * interval of a mean over frames is Student's t on the means of batches of frames (Schmeiser,
 * Operations Research 30, 1982). Batches are whole four-frame cycles, so a cycle never widens the
 * interval. Batch means are slightly correlated themselves. The resulting bias of their variance is
 * known exactly for a first-order autoregressive series; it is corrected with the measured
 * correlation of neighbouring frames (never narrowing the interval).
 *
 * Coverage of a 95 % interval, measured in tests/metrics/test_series.c for Gaussian series with
 * correlation 0 to 0.8 between neighbours, with or without a cycle: 94 to 96 % from 128 frames on,
 * 93 to 96 % from 64 on. It is lower for series with longer memory: 92 % for half white noise and
 * half correlation 0.8; at correlation 0.95, 89 % for 128 frames and 91 % for 256. Trends are not
 * covered.
 */
#ifndef NEPH_METRICS_SERIES_H
#define NEPH_METRICS_SERIES_H

#include "metrics/metric.h"

enum {
    NEPH_CYCLE_FRAMES = 4,
    NEPH_BATCH_FRAMES = 16,    /* from 128 frames on; doubled to stay below 64 batches */
    NEPH_BATCH_FRAMES_FEW = 8, /* below 128 frames */
    NEPH_BATCHES_MIN = 8,      /* fewer batches: no interval */
    NEPH_BATCHES_LIMIT = 64,
};

/* The replicates of a series. */
enum neph_replicate {
    NEPH_REPLICATE_FRAMES, /* frames of one sequence, in order, without warm-up */
    NEPH_REPLICATE_RUNS,   /* independent runs: seeds, camera paths, scenes; in any order */
    NEPH_REPLICATE_COUNT,
};

/* A mean. Undefined (all zero) without a value, or with one that is not finite. The interval is
 * - NEPH_INTERVAL_DETERMINISTIC without randomness: at least two equal values, or frames that
 *   repeat exactly with a period of 4 or 16;
 * - NEPH_INTERVAL_NONE below 64 frames or two runs;
 * - else NEPH_INTERVAL_CYCLES with n batches, or NEPH_INTERVAL_RUNS with n runs.
 *
 * In the first two cases n is the number of values. */
struct neph_mean {
    bool defined;
    double value;
    double low, high; /* 95 %; 0 without an interval, `value` if deterministic */
    enum neph_interval_kind interval;
    int n;
    double standard_error; /* 0 without an interval; n - 1 degrees of freedom */
};

/* The mean of `count` values. Frames are used in whole cycles: extra frames at the start, next to
 * the warm-up, are left out (all frames are used if there is no whole cycle). */
struct neph_mean neph_series_mean(const double *values, int count, enum neph_replicate replicate);

/* Paired comparison a - b, value by value: the same frames, or the same runs, of two methods. */
struct neph_paired {
    struct neph_mean difference;
    double p;               /* two-sided, Student's t; 1 without an interval */
    int positive, negative; /* batches (runs) in which a is above or below; equal ones do not
                             * count */
    double p_sign;          /* two-sided, exact sign test on these; 1 when there are none */
};

/* Compare two series. NEPH_ERR_MEMORY. */
enum neph_status neph_series_paired(const double *a, const double *b, int count,
                                    enum neph_replicate replicate, struct neph_paired *paired,
                                    struct neph_diag *diag);

/* Compare two numbers by their draws (metric.h) from the same tiles: the draws are paired, so
 * common variation cancels. The interval, NEPH_INTERVAL_TILES with n tiles, is the 2.5th to 97.5th
 * percentile of the differences of the draws; p is Student's t on their standard deviation, with n
 * - 1 degrees of freedom; there are no signs. Undefined if the tiles differ, or if a draw is not
 * finite. */
struct neph_paired neph_series_paired_draws(double a, const struct neph_draws *draws_a, double b,
                                            const struct neph_draws *draws_b);

#endif

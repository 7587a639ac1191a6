/* SPDX-License-Identifier: MIT
 *
 * Means of series of numbers, one number a frame or one a run, and how sure they are; and whether
 * one series lies above another.
 *
 * Neighbouring frames err together, so the frame is not the unit of replication. The interval of a
 * mean over frames is Student's t on the means of batches of frames (Schmeiser, Operations Research
 * 30, 1982), batches being whole four-frame cycles, so that a cycle never widens it. Batch means
 * are themselves a little correlated; the bias that this gives to their variance is known exactly
 * for an autoregressive series of first order, and is taken out with the correlation of
 * neighbouring frames as measured (never to make an interval narrower).
 *
 * What a 95 % interval covers, measured in tests/metrics/test_series.c for Gaussian series of the
 * correlation 0 to 0.8 between neighbours, with a cycle or without: 94 to 96 % from 128 frames on,
 * 93 to 96 % from 64 on. It covers less when a series remembers for longer than it looks (92 % for
 * half white noise and half correlation 0.8; at the correlation 0.95 89 % for 128 frames and 91 %
 * for 256), and knows nothing of a trend.
 */
#ifndef NEPH_METRICS_SERIES_H
#define NEPH_METRICS_SERIES_H

#include "metrics/metric.h"

enum {
    NEPH_CYCLE_FRAMES = 4,
    NEPH_BATCH_FRAMES = 16,    /* from 128 frames on; doubled so that there are never 64 batches */
    NEPH_BATCH_FRAMES_FEW = 8, /* below 128 frames */
    NEPH_BATCHES_MIN = 8,      /* no interval below */
    NEPH_BATCHES_LIMIT = 64,
};

/* What a series counts. */
enum neph_replicate {
    NEPH_REPLICATE_FRAMES, /* of one sequence, in order, warm-up left out */
    NEPH_REPLICATE_RUNS,   /* independent: seeds, camera paths, scenes; in any order */
    NEPH_REPLICATE_COUNT,
};

/* A mean. Undefined (all zero) when there is no value, or one that is not finite.
 * The interval is DETERMINISTIC when nothing was drawn: at least two equal values, or frames that
 * repeat exactly with a period of 4 or 16. It is NONE below 64 frames or two runs; CYCLES with n
 * the number of batches, or RUNS with n the number of runs; else n is the number of values. */
struct neph_mean {
    bool defined;
    double value;
    double low, high; /* 95 %; 0 without an interval, `value` when deterministic */
    enum neph_interval_kind interval;
    int n;
    double standard_error; /* 0 without an interval; n - 1 degrees of freedom */
};

/* The mean of `count` values. Of frames, whole cycles alone are used: what is over at the start,
 * next to the warm-up, is left out (all are used when there is not one cycle). */
struct neph_mean neph_series_mean(const double *values, int count, enum neph_replicate replicate);

/* a - b, value by value: the same frames, or the same runs, once each way. */
struct neph_paired {
    struct neph_mean difference;
    double p;               /* two-sided, Student's t; 1 without an interval */
    int positive, negative; /* batches (runs) in which a lies above, below; equal ones count not */
    double p_sign;          /* two-sided, exact sign test on these; 1 when there are none */
};

/* Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_series_paired(const double *a, const double *b, int count,
                                    enum neph_replicate replicate, struct neph_paired *paired,
                                    struct neph_diag *diag);

/* a - b of two numbers with their draws (metric.h), which are of the same tiles: as they are drawn
 * alike, what both have in common falls out. The interval, NEPH_INTERVAL_TILES with n tiles, is
 * from the 2.5th to the 97.5th percentile of the differences of the draws; p is Student's t on
 * their standard deviation, n - 1 degrees of freedom; there are no signs. Undefined when the tiles
 * are not the same, or a draw is not finite. */
struct neph_paired neph_series_paired_draws(double a, const struct neph_draws *draws_a, double b,
                                            const struct neph_draws *draws_b);

#endif

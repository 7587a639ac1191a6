/* SPDX-License-Identifier: MIT
 *
 * Statistical test of a nightly run against the accepted runs. Input and output are numbers: this
 * module knows no files, renderers or databases.
 *
 * A series has changed when the change is larger than noise and larger than the threshold of its
 * kind (`least`). The model of the noise depends on the kind:
 *
 * - fixed: deterministic. The same program gives the same bits, so any change is real.
 * - drawn: a Monte Carlo estimate with a standard error. Equal bits are no change. With few runs: a
 *   normal test with the errors of both values. With enough runs: also the test for timed series,
 *   and the larger p-value counts. A run that repeats the bits of the run before it is no new
 *   sample, because the program was the same.
 * - timed: a duration divided by the calibration time of the same run, compared as a logarithm.
 *   Student's t of this run against the first 30 runs of the baseline, with their trimmed mean and
 *   the winsorized deviation, a fifth on either side (K. Yuen, Biometrika 61, 1974; here for a new
 *   value instead of a mean). Consecutive runs are correlated: the degrees of freedom and the error
 *   of the mean follow a first-order autoregressive series with the estimated correlation
 *   (Zwiers and von Storch, Journal of Climate 8, 1995). A single run on a loaded machine is no
 *   change: the test takes the least deviation of the last three runs, all of which must deviate to
 *   the same side.
 *
 * Drawn and timed series are tested twice, with this run and with the median of the last seven
 * runs, and their p-values are doubled for that. Each engine's mean over all scenes is a further
 * series; it shows changes that are too small in a single scene. Holm's correction covers all
 * p-values of a run: a run without any change raises an alarm with a probability of at most
 * `alpha`. tests/harness/test_backtest.c measures the actual rate.
 */
#ifndef NEPH_HARNESS_NIGHT_JUDGE_H
#define NEPH_HARNESS_NIGHT_JUDGE_H

#include "base/arena.h"
#include "base/status.h"

#include <stdbool.h>

enum neph_series_kind {
    NEPH_SERIES_FIXED,
    NEPH_SERIES_DRAWN,
    NEPH_SERIES_TIMED,
    NEPH_SERIES_KINDS,
};

struct neph_series_rule {
    const char *word;
    double least; /* threshold of the relative change */
    int nights;   /* baseline runs needed for a test without standard errors */
    int needed;   /* consecutive runs that must deviate to the same side */
};

const struct neph_series_rule *neph_series_rule(enum neph_series_kind kind);

/* The kind with this name; NEPH_SERIES_KINDS: unknown. */
enum neph_series_kind neph_series_kind_of(const char *word);

enum { NEPH_JUDGE_WINDOW = 30, NEPH_JUDGE_WEEK = 7 };

/* `past` has one element for each run from the baseline, the first element, to the last run before
 * this one; NaN where a run has no such number. Series with the same baseline have the same runs,
 * and are pooled. */
struct neph_series {
    const char *name;
    const char *engine; /* the pool over all scenes is by engine and metric; NULL: no pool */
    const char *metric;
    const char *truth;  /* reference of an error; NULL: the series is a duration */
    const char *family; /* engines that share a program, and so its faults; NULL: `engine` */
    enum neph_series_kind kind;
    bool is_signed; /* worse is further from 0, and there is no pool; otherwise worse is larger */
    double unit; /* changes are relative to the baseline's value or to this, whichever is larger */
    double tonight, standard_error;   /* standard_error NaN: unknown */
    const double *past, *past_errors; /* `past_count` elements; borrowed */
    const bool *set_aside; /* runs that had changed and are left out of the baseline; NULL: none */
    int past_count;
};

enum neph_judged {
    NEPH_JUDGED_NOT,    /* too few runs, or none that is comparable */
    NEPH_JUDGED_SAME,   /* no significant change */
    NEPH_JUDGED_MOVED,  /* a significant change below the threshold */
    NEPH_JUDGED_BETTER, /* a significant change above the threshold, for the better */
    NEPH_JUDGED_WORSE,
    NEPH_JUDGED_COUNT,
};

const char *neph_judged_word(enum neph_judged judged);

struct neph_judgement {
    enum neph_judged judged;
    double baseline; /* value of the baseline; NaN when the series is not judged */
    double change;   /* relative; for a duration the factor minus 1 */
    double p;        /* after Holm's correction; 0 for a fixed series that has changed */
    double floor;    /* smallest change that this run could have detected */
    int nights;      /* runs in the baseline */
};

/* An engine's mean over all scenes, by metric. */
struct neph_pool {
    const char *engine, *metric;
    enum neph_series_kind kind;
    int scenes; /* scenes in the mean: they have a number in this run and in the baseline run */
    struct neph_judgement judgement; /* baseline 1; this run's value is 1 + change */
    double *nights; /* 1 + change of each run, from the baseline run (1) to this one; NaN for runs
                       that are left out */
    int night_count;
};

/* True when the series is part of this mean. */
bool neph_pool_has(const struct neph_pool *pool, const struct neph_series *series);

/* Many series with one reference moved, of engines that share no program: check the reference
 * first. */
struct neph_stale {
    const char *truth;
    int moved, all, families; /* series that moved, all series, families of engines that moved */
};

enum { NEPH_JUDGE_TRUTHS_MAX = 16 };

struct neph_verdicts {
    struct neph_arena arena;
    struct neph_judgement *series; /* in the order of the input; allocated in the arena */
    struct neph_pool *pools;       /* allocated in the arena, as are their `nights` */
    int pool_count;
    struct neph_stale stale[NEPH_JUDGE_TRUTHS_MAX];
    int stale_count;
    int compared; /* series and pools that were judged */
    int chances;  /* series with noise: the family of Holm's correction */
    int worse, better, moved;
};

/* Judge a run. 0 < alpha < 1. Free `verdicts` with neph_verdicts_finish(). NEPH_ERR_MEMORY. */
enum neph_status neph_judge(const struct neph_series *series, int count, double alpha,
                            struct neph_verdicts *verdicts, struct neph_diag *diag);
void neph_verdicts_finish(struct neph_verdicts *verdicts);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Is a night worse than the nights that were accepted? Numbers in, verdicts out: nothing here knows
 * a file, a renderer or a database.
 *
 * A series is called changed when two things hold: the change is more than chance, and it is large
 * enough to matter (`least` of its kind). Chance is treated by kind:
 *
 * fixed    the same bits every night while nothing changes, so that any change is more than chance.
 * drawn    the value comes with a standard error. The same bits are no change; else, until there
 *          are enough nights, a normal test on the errors of both; then as timed, whichever is less
 *          sure. Nights that repeat the bits of the night before are none of these: the program
 *          was the same, and nothing was drawn.
 * timed    a duration over that of a calibration kernel of the same night, compared as logarithms:
 *          Student's t of tonight against the first 30 nights of the baseline, by their mean and
 *          deviation without the outer fifth on either side (K. Yuen, Biometrika 61, 1974; for a
 *          new value and not a mean). Nights that follow each other hang together: the degrees of
 *          freedom and the error of the mean are those of an autoregressive series of first order
 *          with the correlation as found (Zwiers and von Storch, Journal of Climate 8, 1995). One
 *          loaded night is no change: what counts is the less deviant of tonight and last night.
 *
 * Drawn and timed series are looked at twice, tonight alone and the mean of the last seven nights,
 * and pay for it by a factor of two. Their engine's mean over all scenes is a series, too, which
 * sees what is too small for one. All p-values of a night go through Holm's correction together, so
 * that a night on which nothing changed alarms with at most the probability `alpha`; how often it
 * does is measured in tests/harness/test_backtest.c.
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
    double least; /* the relative change from which on it matters */
    int nights;   /* that a baseline needs to be judged without standard errors */
    int needed;   /* nights in a row that must deviate to one side */
};

const struct neph_series_rule *neph_series_rule(enum neph_series_kind kind);

/* The kind of a word; NEPH_SERIES_KINDS: there is none. */
enum neph_series_kind neph_series_kind_of(const char *word);

enum { NEPH_JUDGE_WINDOW = 30, NEPH_JUDGE_WEEK = 7 };

/* `past` has a place for each night from the accepted one on, which is the first, to the last but
 * tonight; NaN where a night has no such number. Series of one accepted night have the same
 * nights, and are pooled. */
struct neph_series {
    const char *name;
    const char *engine; /* its mean over all scenes is pooled with those of `metric`; NULL: none */
    const char *metric;
    const char *truth;  /* what errors are against; NULL: a duration */
    const char *family; /* engines that share a program, and so its faults; NULL: the engine */
    enum neph_series_kind kind;
    bool is_signed; /* worse is further from 0, and there is no mean over scenes; else: larger */
    double unit; /* changes are relative to the baseline's value, or to this where that is less */
    double tonight, standard_error;   /* the latter NaN: not known */
    const double *past, *past_errors; /* of `past_count`; borrowed */
    const bool *set_aside; /* nights that are no part of the baseline, as they had changed; NULL:
                              none */
    int past_count;
};

enum neph_judged {
    NEPH_JUDGED_NOT,    /* too few nights, or none that may be compared */
    NEPH_JUDGED_SAME,   /* no change that is more than chance */
    NEPH_JUDGED_MOVED,  /* changed, by less than matters */
    NEPH_JUDGED_BETTER, /* changed by more, for the better */
    NEPH_JUDGED_WORSE,
    NEPH_JUDGED_COUNT,
};

const char *neph_judged_word(enum neph_judged judged);

struct neph_judgement {
    enum neph_judged judged;
    double baseline; /* what tonight is held against; NaN when it is not judged */
    double change;   /* relative; of a duration, the factor less 1 */
    double p;        /* after Holm's correction; 0 of a fixed series that has changed */
    double floor;    /* the least change that this series could have shown tonight */
    int nights;      /* behind the baseline */
};

/* An engine's mean over all scenes, by metric. */
struct neph_pool {
    const char *engine, *metric;
    enum neph_series_kind kind;
    int scenes; /* in the mean: those with a number of tonight and of the accepted night */
    struct neph_judgement judgement; /* baseline 1; tonight is 1 + change */
    double *nights; /* 1 + change of each, from the accepted one, 1, to tonight; NaN of those that
                       are left out */
    int night_count;
};

/* Whether a series is of an engine and metric that have this mean. */
bool neph_pool_has(const struct neph_pool *pool, const struct neph_series *series);

/* Many series against one truth moved, of engines that share no program: it is the truth that is to
 * be looked at first. */
struct neph_stale {
    const char *truth;
    int moved, all, families; /* series; families of engines that moved */
};

enum { NEPH_JUDGE_TRUTHS_MAX = 16 };

struct neph_verdicts {
    struct neph_arena arena;
    struct neph_judgement *series; /* in the order of the series; of the arena */
    struct neph_pool *pools;       /* of the arena, as their nights */
    int pool_count;
    struct neph_stale stale[NEPH_JUDGE_TRUTHS_MAX];
    int stale_count;
    int compared; /* series and pools that were judged */
    int chances;  /* of them, those in which chance has a part: the family of Holm's correction */
    int worse, better, moved;
};

/* Judge a night. alpha in (0, 1). Free `verdicts` with neph_verdicts_finish(). NEPH_ERR_MEMORY. */
enum neph_status neph_judge(const struct neph_series *series, int count, double alpha,
                            struct neph_verdicts *verdicts, struct neph_diag *diag);
void neph_verdicts_finish(struct neph_verdicts *verdicts);

#endif

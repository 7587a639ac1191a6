/* SPDX-License-Identifier: MIT
 *
 * Compares a nightly run in the store's history with the baseline, the last accepted run: selects
 * the numbers that are comparable, passes them to judge.h, and adds findings that are not about a
 * number, such as missing series, changed frame sizes and blank frames.
 */
#ifndef NEPH_HARNESS_NIGHT_COMPARE_H
#define NEPH_HARNESS_NIGHT_COMPARE_H

#include "base/arena.h"
#include "harness/night/judge.h"
#include "harness/night/lost.h"
#include "harness/run/database.h"

#include <stdint.h>

/* Sorted by severity. NEPH_FOUND_BETTER and the kinds after it do not fail a run. */
enum neph_found {
    NEPH_FOUND_STEP,    /* a step failed or exceeded its time limit */
    NEPH_FOUND_HISTORY, /* records of an accepted run are truncated, missing or modified */
    NEPH_FOUND_BITS,    /* a repeated step of the same program gave other numbers */
    NEPH_FOUND_STALE,   /* many series of a reference moved: the reference is suspected */
    NEPH_FOUND_BLANK,   /* a frame became blank, or has NaN or infinite pixels */
    NEPH_FOUND_MISSING, /* the step is done, without this series */
    NEPH_FOUND_LOST,    /* the step is not planned, or too many runs have not compared it */
    NEPH_FOUND_SIZE,
    NEPH_FOUND_WORSE,
    NEPH_FOUND_WORSE_ELSEWHERE, /* worse than in another environment */
    NEPH_FOUND_EDITED,          /* the scene was edited, which starts new series */
    NEPH_FOUND_BETTER,
    NEPH_FOUND_ENVIRONMENT, /* other versions or another device: not compared */
    NEPH_FOUND_MOVED,       /* changed by less than the threshold */
    NEPH_FOUND_COUNT,
};

const char *neph_found_word(enum neph_found found);
bool neph_found_fails(enum neph_found found);

/* Texts are allocated in the arena. Missing numbers are NaN. */
struct neph_finding {
    enum neph_found found;
    const char *series; /* or a step, a reference, or "engine, metric, all scenes" */
    const char *step;   /* "" for a finding over several steps */
    const char *words;  /* the finding as a sentence */
    double tonight, baseline, change, p, floor;
    double standard_error; /* of `tonight`, as the engine reports it */
    const char *example;   /* a series that illustrates the finding; "": none */
    int64_t accepted;      /* number of the run that it is compared with; 0: none */
    const double *trend;   /* for a mean over scenes: 1 + its change in each run from the baseline
                              to this one; NULL: use the course of the series */
    int trend_count;
};

/* The result for one number. */
struct neph_compared {
    const char *series, *step;
    const char *why; /* reason why it is not judged; otherwise "" */
    double tonight;
    struct neph_judgement judgement;
};

/* Start from {0}; free with neph_night_comparison_finish(). */
struct neph_night_comparison {
    struct neph_arena arena;
    int64_t night, baseline; /* `baseline`: last acceptance of all series; 0: none */
    struct neph_finding *findings;
    int finding_count, finding_room;
    struct neph_compared *series;
    int series_count;
    int compared, chances;       /* `compared`: number of comparisons, means over scenes included;
                                    `chances`: those with noise */
    int fresh, elsewhere, young; /* series of the baseline with planned steps that were not run */
    int not_run;                 /* baseline series with planned steps that did not run */
    bool passes;                 /* at least one comparison, and no finding that fails */
};

/* Compare a run with the baseline, or with run `against` unless that is 0. `scope` NULL: no step
 * was left out of the plan. NEPH_ERR_NOT_FOUND: there is no such run. Other errors: see
 * database.h. */
enum neph_status neph_night_compare(struct neph_database *index, int64_t night, int64_t against,
                                    const struct neph_night_scope *scope, double alpha,
                                    struct neph_night_comparison *comparison,
                                    struct neph_diag *diag);

/* The verdict in words: "pass" and "passes", and so on. */
struct neph_night_verdict {
    const char *word, *verb;
};

struct neph_night_verdict neph_night_verdict(const struct neph_night_comparison *comparison);

/* A finding without numbers and without a baseline run. */
struct neph_finding neph_finding(enum neph_found found, const char *series, const char *step,
                                 const char *words);

/* Set `passes` from the findings. */
void neph_night_settle(struct neph_night_comparison *comparison);

/* Add a finding of another check and update `passes`. When memory is short, neph_arena_check() of
 * the comparison's arena returns an error. */
void neph_night_add_finding(struct neph_night_comparison *comparison,
                            const struct neph_finding *finding);

void neph_night_comparison_finish(struct neph_night_comparison *comparison);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A night of the store's history against the nights that were accepted: which of its numbers may be
 * compared with which, what judge.h says of them, and what is not a number at all: missing frames,
 * another size, a blank picture.
 */
#ifndef NEPH_HARNESS_NIGHT_COMPARE_H
#define NEPH_HARNESS_NIGHT_COMPARE_H

#include "base/arena.h"
#include "harness/night/judge.h"
#include "harness/night/lost.h"
#include "harness/run/database.h"

#include <stdint.h>

/* In the order in which they are told. From NEPH_FOUND_BETTER on they fail no night. */
enum neph_found {
    NEPH_FOUND_STEP,    /* a step broke, or did not end in time */
    NEPH_FOUND_HISTORY, /* what was accepted is torn, missing or not as it was written */
    NEPH_FOUND_BITS,    /* the same program gave other numbers when it was run once more */
    NEPH_FOUND_STALE,   /* many series of a truth moved: the truth is suspected */
    NEPH_FOUND_BLANK,   /* a picture is empty that was not, or has pixels that are no numbers */
    NEPH_FOUND_MISSING, /* its step was done, and did not give the number */
    NEPH_FOUND_LOST, /* its step is not in the plan, or it was not compared for too many nights */
    NEPH_FOUND_SIZE,
    NEPH_FOUND_WORSE,
    NEPH_FOUND_WORSE_ELSEWHERE, /* in another environment */
    NEPH_FOUND_EDITED,          /* a scene, so that its series are others */
    NEPH_FOUND_BETTER,
    NEPH_FOUND_ENVIRONMENT, /* other versions or another device: not compared */
    NEPH_FOUND_MOVED,       /* by less than matters */
    NEPH_FOUND_COUNT,
};

const char *neph_found_word(enum neph_found found);
bool neph_found_fails(enum neph_found found);

/* Texts are of the arena. Numbers are NaN where there are none. */
struct neph_finding {
    enum neph_found found;
    const char *series; /* or step, or truth, or "engine, metric, all scenes" */
    const char *step;   /* "" of what is of several */
    const char *words;  /* what was found, in a sentence */
    double tonight, baseline, change, p, floor;
    double standard_error; /* of tonight's number, as its engine tells it */
    const char *example;   /* the series to show it by; "" when there is none */
    int64_t accepted;      /* the night that it is held against; 0: none */
    const double *trend;   /* of a mean over scenes: 1 + its change, on each night from the accepted
                              one to this; NULL: it is that of the series */
    int trend_count;
};

/* What became of each number. */
struct neph_compared {
    const char *series, *step;
    const char *why; /* it is not judged; else "" */
    double tonight;
    struct neph_judgement judgement;
};

/* Start from {0}; free with neph_night_comparison_finish(). */
struct neph_night_comparison {
    struct neph_arena arena;
    int64_t night, baseline; /* the accepted night of all; 0: there is none */
    struct neph_finding *findings;
    int finding_count, finding_room;
    struct neph_compared *series;
    int series_count;
    int compared, chances;       /* comparisons made, means over scenes included */
    int fresh, elsewhere, young; /* not compared: new series, another environment, too few nights */
    int not_run; /* series of the baseline whose steps are in the plan and were not run tonight */
    bool passes; /* something was compared, and no finding fails it */
};

/* Compare a night with the last that was accepted, or with night `against` where that is not 0.
 * `scope` NULL: no step was left out of the plan. Errors: as of database.h; NEPH_ERR_NOT_FOUND:
 * there is no such night. */
enum neph_status neph_night_compare(struct neph_database *index, int64_t night, int64_t against,
                                    const struct neph_night_scope *scope, double alpha,
                                    struct neph_night_comparison *comparison,
                                    struct neph_diag *diag);

/* What a comparison comes to, in words: "pass", "passes" and the like. */
struct neph_night_verdict {
    const char *word, *verb;
};

struct neph_night_verdict neph_night_verdict(const struct neph_night_comparison *comparison);

/* A finding without numbers, and of no accepted night. */
struct neph_finding neph_finding(enum neph_found found, const char *series, const char *step,
                                 const char *words);

/* Say whether the night passes, by its findings. */
void neph_night_settle(struct neph_night_comparison *comparison);

/* Add what somebody else has found, and judge anew whether the night passes. When memory is short,
 * neph_arena_check() of its arena says so. */
void neph_night_add_finding(struct neph_night_comparison *comparison,
                            const struct neph_finding *finding);

void neph_night_comparison_finish(struct neph_night_comparison *comparison);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The state of a nightly run in progress: its identity, its plan, and the history of its steps.
 * Shared by the executors in night.c and send.c.
 */
#ifndef NEPH_HARNESS_NIGHT_WORK_H
#define NEPH_HARNESS_NIGHT_WORK_H

#include "harness/night/compare.h"
#include "harness/night/jobs.h"
#include "harness/night/limits.h"
#include "harness/night/plan.h"
#include "harness/night/step.h"
#include "harness/progress.h"
#include "harness/run/store.h"

struct neph_night;

struct neph_night_params {
    struct neph_night_plan_params plan;
    const char *output;   /* the folder of the store */
    const char *revision; /* revision of the sources as the caller names it; "" */
    double budget_s;      /* steps that do not fit are not started; infinite: all */
    int64_t against;      /* number of the run to compare with; 0: the baseline */
    const struct neph_night_limits *limits; /* of series; NULL: none */
    bool once;                              /* repeat no step */
    bool reports;                           /* jobs have run the steps: read their result files */
    bool quiet;

    /* Called after each step with the results so far; may be NULL. */
    enum neph_status (*show)(const struct neph_night *night, void *context, struct neph_diag *diag);
    void *context;
};

/* The outcome of a step, as in struct neph_history_step; NULL when the step was not run. */
struct neph_night_outcome {
    const char *outcome, *reason;
};

/* Start from {0}; free with neph_night_finish(). Texts are allocated in the arena. */
struct neph_night {
    struct neph_arena arena;
    struct neph_night_plan plan;
    int64_t id;
    bool resumed, is_over, is_interrupted;
    const char *revision, *host, *program, *started_utc;
    const struct neph_night_outcome *outcomes; /* one for each step of the plan */
    int done_count;                            /* steps that measured their numbers */
    int again_count;                           /* steps that were repeated */
    double seconds;                            /* duration of this process */
    struct neph_night_comparison comparison;
};

/* Texts are allocated in the run's arena. */
struct neph_night_work {
    const struct neph_night_params *params;
    struct neph_store *store;
    struct neph_night *night;
    struct neph_step_history *history;
    struct neph_night_outcome *outcomes; /* one for each step of the plan */
    double *longest_s;                   /* longest duration of each step that ended as done */
    bool *ran;
    int ran_count;
    const char *folder, *logs; /* OUTPUT/nightly and its logs/ */
    struct neph_step_place place;
    struct neph_night_jobs jobs; /* for a run that submits its steps as jobs */
    struct neph_progress progress;
    double start_s;
};

/* Make the plan and the folders, and identify the program and the host class. */
enum neph_status neph_night_prepare(struct neph_night_work *work, struct neph_diag *diag);

/* Lock the output folder against other nightly runs; closing `*lock` releases it. With `waits` the
 * function blocks until the lock is free, otherwise it returns NEPH_ERR_UNAVAILABLE. */
enum neph_status neph_night_lock(const struct neph_night_work *work, bool waits, int *lock,
                                 struct neph_diag *diag);

/* Start or resume the run and read the history of its steps. A run of submitted jobs takes its
 * number and its start time from night.json. */
enum neph_status neph_night_begin(struct neph_night_work *work, struct neph_diag *diag);

struct neph_history_night neph_night_identity(const struct neph_night *night);

/* The time limit of a step; a step that exceeds it is regarded as hanging. */
double neph_night_limit_s(const struct neph_night_work *work, int step);

/* Record the outcome of a step that this run, or its killed predecessor, has run. */
void neph_night_note(struct neph_night_work *work, int step, const char *outcome,
                     const char *reason);

/* For each edited scene, run its step once more with the accepted version of the scene, and store
 * the numbers under the step "NAME, as accepted". `scope` gets the edits and their results; texts
 * are allocated in the run's arena. A failed rendering of an accepted version is not an error. */
enum neph_status neph_night_render_accepted(struct neph_night_work *work,
                                            struct neph_night_scope *scope, struct neph_diag *diag);

/* The path of a step's log: its name followed by `ending`. */
const char *neph_night_log(struct neph_night_work *work, int step, const char *ending);

#endif

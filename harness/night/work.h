/* SPDX-License-Identifier: MIT
 *
 * A night at work: who it is, its plan, and what history knows of its steps.
 */
#ifndef NEPH_HARNESS_NIGHT_WORK_H
#define NEPH_HARNESS_NIGHT_WORK_H

#include "harness/night/compare.h"
#include "harness/night/jobs.h"
#include "harness/night/plan.h"
#include "harness/night/step.h"
#include "harness/progress.h"
#include "harness/run/store.h"

struct neph_night;

struct neph_night_params {
    struct neph_night_plan_params plan;
    const char *output;   /* the folder of the store */
    const char *revision; /* of the sources, as the caller names it; "" */
    double budget_s;      /* no step begins that does not fit; infinite: all */
    int64_t against;      /* the night to compare with; 0: the accepted one */
    bool once;            /* nothing is run a second time */
    bool reports;         /* jobs have run the steps: read what they have left */
    bool quiet;

    /* Called with what is there so far; NULL: nobody looks. */
    enum neph_status (*show)(const struct neph_night *night, void *context, struct neph_diag *diag);
    void *context;
};

/* What became of a step: as in struct neph_history_step; NULL when it was not run. */
struct neph_night_outcome {
    const char *outcome, *reason;
};

/* Start from {0}; free with neph_night_finish(). Texts are of the arena. */
struct neph_night {
    struct neph_arena arena;
    struct neph_night_plan plan;
    int64_t id;
    bool resumed, is_over, is_interrupted;
    const char *revision, *host, *program, *started_utc;
    const struct neph_night_outcome *outcomes; /* of the plan's steps */
    int done_count;                            /* steps that gave their numbers */
    int again_count;                           /* those that gave them once more */
    double seconds;                            /* of this run */
    struct neph_night_comparison comparison;
};

/* Texts are of the night's arena. */
struct neph_night_work {
    const struct neph_night_params *params;
    struct neph_store *store;
    struct neph_night *night;
    struct neph_step_history *history;
    struct neph_night_outcome *outcomes; /* of the plan's steps */
    double *longest_s;                   /* that it ever took and was done */
    bool *ran;
    int ran_count;
    const char *folder, *logs; /* OUTPUT/nightly and its logs/ */
    struct neph_step_place place;
    struct neph_night_jobs jobs; /* of a night whose steps are run elsewhere */
    struct neph_progress progress;
    double start_s;
};

/* Make the plan and the folders; tell who this program and this machine are. */
enum neph_status neph_night_prepare(struct neph_night_work *work, struct neph_diag *diag);

/* Nobody else writes the night of this output until `*lock` is closed. NEPH_ERR_UNAVAILABLE:
 * somebody does, and `waits` is false. */
enum neph_status neph_night_lock(const struct neph_night_work *work, bool waits, int *lock,
                                 struct neph_diag *diag);

/* Begin the night, or go on with it, and read what history knows of its steps. One of jobs that
 * were sent has its number and its time from whoever sent them. */
enum neph_status neph_night_begin(struct neph_night_work *work, struct neph_diag *diag);

struct neph_history_night neph_night_who(const struct neph_night *night);

/* What takes longer hangs. */
double neph_night_limit_s(const struct neph_night_work *work, int step);

/* The step was run, tonight or by a run of this night that was killed. */
void neph_night_note(struct neph_night_work *work, int step, const char *outcome,
                     const char *reason);

/* Find the edits of tonight, run the step of each once more with the accepted version in place of
 * the edited scene, and keep its numbers as measured by the step "NAME, as accepted". `scope` gets
 * the edits with what became of them; texts are of the night's arena. An accepted version that
 * cannot be rendered is no error. */
enum neph_status neph_night_render_accepted(struct neph_night_work *work,
                                            struct neph_night_scope *scope, struct neph_diag *diag);

/* Where the log of a step goes. */
const char *neph_night_log(struct neph_night_work *work, int step, const char *ending);

#endif

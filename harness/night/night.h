/* SPDX-License-Identifier: MIT
 *
 * A night: steps of a plan, each run as a command of its own, their numbers kept in the store's
 * history, the whole compared with the accepted night. A night that was killed or interrupted goes
 * on where it stopped, with the same plan, program and revision.
 *
 * As long as the program is the same its frames are not rendered again, but for a step or two in
 * turn, which must give the same numbers to the last bit in an empty folder.
 */
#ifndef NEPH_HARNESS_NIGHT_NIGHT_H
#define NEPH_HARNESS_NIGHT_NIGHT_H

#include "harness/night/compare.h"
#include "harness/night/plan.h"
#include "harness/run/store.h"

struct neph_night;

struct neph_night_params {
    struct neph_night_plan_params plan;
    const char *output;   /* the folder of the store */
    const char *revision; /* of the sources, as the caller names it; "" */
    double budget_s;      /* no step begins that does not fit; infinite: all */
    int64_t against;      /* the night to compare with; 0: the accepted one */
    bool once;            /* nothing is run a second time */
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

/* Run, compare, and keep. NEPH_OK also when it does not pass: the comparison says so.
 * NEPH_ERR_INTERRUPTED: what was done is kept. NEPH_ERR_UNAVAILABLE: another night is at work in
 * the folder. */
enum neph_status neph_night_run(const struct neph_night_params *params, struct neph_store *store,
                                struct neph_night *night, struct neph_diag *diag);
void neph_night_finish(struct neph_night *night);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The stress tests: scenarios of scenes/stress with presets of `realtime`. Each value is compared
 * with its limit (scenes/failing.h) and judged by its expectation (expectations.h). Finished trials
 * are in the store, where an interrupted run resumes; a changed limit needs no new frames.
 */
#ifndef NEPH_HARNESS_STRESS_SUITE_H
#define NEPH_HARNESS_STRESS_SUITE_H

#include "harness/run/store.h"
#include "harness/stress/results.h"
#include "scenes/failing.h"

/* Runs the tests. NEPH_OK also when the verdict is "fail". NEPH_ERR_USAGE: no such scenario or
 * preset. NEPH_ERR_INTERRUPTED: finished trials stay in the store. Call neph_stress_finish() in any
 * case. */
enum neph_status neph_stress_run(const struct neph_stress_params *params, struct neph_store *store,
                                 struct neph_stress_suite *suite, struct neph_diag *diag);

/* A trial: one column at one sweep point. */
struct neph_stress_trial {
    int row, column; /* first row of the point */
    bool is_later;   /* an earlier trial of the point makes the reference of both */
    double cost;     /* estimated cost: samples along the rays of all frames */
};

/* The list is in the suite's arena. */
struct neph_stress_trials {
    struct neph_stress_trial *list;
    int count;
};

/* Lists all trials of a suite. For one process: point by point, so that a loaded scene serves
 * several trials. For several processes (`are_spread`): trials that make a reference before those
 * that use it, and long trials before short ones, so that all processes are busy until the end. */
enum neph_status neph_stress_list_trials(struct neph_stress_suite *suite, bool are_spread,
                                         struct neph_stress_trials *trials, struct neph_diag *diag);

/* ---- its parts ------------------------------------------------------------------------------- */

/* Selects scenes, columns and rows of `suite`. Errors as of neph_stress_run(). */
enum neph_status neph_stress_plan(const struct neph_stress_params *params,
                                  struct neph_stress_suite *suite, struct neph_diag *diag);

/* Whether a limit of a scenario is measured in a column:
 *
 * - a user engine ("command"): always, as its weaknesses are not known;
 * - a preset: when the scenario names it, the preset on which it is based, or no preset;
 * - another engine: when the scenario is for engines and the measure is not over time. */
bool neph_stress_measures(const struct neph_failing *failing,
                          const struct neph_failing_limit *limit,
                          const struct neph_stress_column *column);

/* The message of a worker to the main process: the cells of a column at a point, and their times.
 */
struct neph_stress_message {
    int first_row, row_count, column; /* of the cells */
    int frame_count;                  /* of the sequence */
    double seconds;                   /* of the trial */
    int reference_count;              /* frames of the reference, rendered or found */
    double reference_s;
};

/* Writes a message, with the cells from `suite`, for free(); NULL: out of memory. */
char *neph_stress_write_message(const struct neph_stress_message *message,
                                const struct neph_stress_suite *suite);

/* Reads a message into the cells of `suite`, which has the same plan. NEPH_ERR_INTERNAL: not a
 * message of such a suite. */
enum neph_status neph_stress_read_message(const char *text, struct neph_stress_suite *suite,
                                          struct neph_stress_message *message,
                                          struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The stress tests: scenarios of scenes/stress over presets of `realtime`, each number compared
 * with its limit (scenes/failing.h) and judged by its expectation (expectations.h). Finished trials
 * are in the store, and the same run goes on from there; a limit that is changed costs no frame.
 */
#ifndef NEPH_HARNESS_STRESS_SUITE_H
#define NEPH_HARNESS_STRESS_SUITE_H

#include "harness/run/store.h"
#include "harness/stress/results.h"
#include "scenes/failing.h"

/* Run it. NEPH_OK also when it does not pass. NEPH_ERR_USAGE: no such scenario or preset.
 * NEPH_ERR_INTERRUPTED: finished trials stay in the store. For _finish in any case. */
enum neph_status neph_stress_run(const struct neph_stress_params *params, struct neph_store *store,
                                 struct neph_stress_suite *suite, struct neph_diag *diag);

/* A trial: a column at a point. */
struct neph_stress_trial {
    int row, column; /* the first row of its point */
    bool is_later;   /* another trial of its point makes the reference of both */
    double cost;     /* samples along rays of all its frames, about */
};

/* The list is in the suite's arena. */
struct neph_stress_trials {
    struct neph_stress_trial *list;
    int count;
};

/* All trials of a suite. For one process: from point to point, so that a loaded scene serves
 * several. For several processes: a trial that makes a reference before those that need it, so that
 * it is made once, and long ones before short ones, so that in the end all are busy. */
enum neph_status neph_stress_list_trials(struct neph_stress_suite *suite, bool are_spread,
                                         struct neph_stress_trials *trials, struct neph_diag *diag);

/* ---- its parts ------------------------------------------------------------------------------- */

/* Scenes, rows and columns of `suite`. Errors as of neph_stress_run(). */
enum neph_status neph_stress_plan(const struct neph_stress_params *params,
                                  struct neph_stress_suite *suite, struct neph_diag *diag);

/* Whether a number of a scenario is measured of a column. All numbers are measured of a user engine
 * ("command"), whose weaknesses are not known; of a preset the numbers of scenarios that name the
 * preset, or no preset, or the preset that it is a change of. */
bool neph_stress_measures(const struct neph_failing *failing,
                          const struct neph_failing_limit *limit,
                          const struct neph_stress_column *column);

/* The message of a worker to the process that shows the run: the cells of a column at a point, and
 * the time that they took. */
struct neph_stress_message {
    int first_row, row_count, column; /* of the cells */
    int frame_count;                  /* of the take */
    double seconds;                   /* of the trial */
    int reference_count;              /* frames of the reference, made or found */
    double reference_s;
};

/* Write it, with the cells of `suite`, for the caller to free; NULL when memory is short. */
char *neph_stress_write_message(const struct neph_stress_message *message,
                                const struct neph_stress_suite *suite);

/* Read it into the cells of `suite`, of the same plan. NEPH_ERR_INTERNAL: it is no message of such
 * a suite. */
enum neph_status neph_stress_read_message(const char *text, struct neph_stress_suite *suite,
                                          struct neph_stress_message *message,
                                          struct neph_diag *diag);

#endif

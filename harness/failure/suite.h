/* SPDX-License-Identifier: MIT
 *
 * The failure suite: scenarios of scenes/failure over presets of `realtime`, each number held
 * against its limit (scenes/failing.h) and against what is expected of it (expectations.h). What is
 * finished is in the store, and the same run goes on from there; a limit that is changed costs no
 * picture.
 */
#ifndef NEPH_HARNESS_FAILURE_SUITE_H
#define NEPH_HARNESS_FAILURE_SUITE_H

#include "harness/failure/results.h"
#include "harness/run/store.h"

/* Run it. NEPH_OK also when it does not pass. NEPH_ERR_USAGE: no such scenario or preset.
 * NEPH_ERR_INTERRUPTED: what is finished stays in the store. For _finish in any case. */
enum neph_status neph_failure_run(const struct neph_failure_params *params,
                                  struct neph_store *store, struct neph_failure_suite *suite,
                                  struct neph_diag *diag);

/* A trial: a column at a point. */
struct neph_failure_trial {
    int row, column; /* the first row of its point */
    bool is_later;   /* another trial of its point makes the reference of both */
    double cost;     /* samples along rays of all its frames, about */
};

/* Start from {0}; free the list. */
struct neph_failure_trials {
    struct neph_failure_trial *list;
    int count;
};

/* All trials of a suite. For one process: from point to point, so that a loaded scene serves
 * several. For several processes: a trial that makes a reference before those that need it, so that
 * it is made once, and long ones before short ones, so that in the end all are busy. */
enum neph_status neph_failure_list_trials(const struct neph_failure_suite *suite, bool are_spread,
                                          struct neph_failure_trials *trials,
                                          struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Speed against accuracy: sweeps of one setting per series over a scene that has an exact answer.
 */
#ifndef NEPH_HARNESS_REPORT_CHARTS_H
#define NEPH_HARNESS_REPORT_CHARTS_H

#include "harness/json.h"
#include "harness/progress.h"
#include "harness/run/store.h"

#include <stdbool.h>

struct neph_charts_params {
    const char *const *ids; /* NULL-terminated; NULL: all */
    int repeats;            /* of each point, 1 .. NEPH_CHARTS_REPEATS_MAX */
    double time_limit_s;    /* per child process */
};

enum { NEPH_CHARTS_REPEATS_MAX = 3 };

/* Run charts and add them to `charts` (the form of scripts/report/README.md). A series whose engine
 * is missing is left out, and the caption says so. */
enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 struct neph_progress *progress, json_t *charts,
                                 struct neph_diag *diag);

/* How many steps of progress that takes, and about how long one is for each repeat. */
int neph_charts_step_count(const struct neph_charts_params *params);
#define NEPH_CHARTS_STEP_TYPICAL_S 1.5

#endif

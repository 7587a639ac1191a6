/* SPDX-License-Identifier: MIT
 *
 * Speed against accuracy: sweeps of one setting per series over a scene that has an exact answer.
 */
#ifndef NEPH_HARNESS_CHARTS_H
#define NEPH_HARNESS_CHARTS_H

#include "harness/json.h"
#include "harness/store.h"

#include <stdbool.h>

struct neph_charts_params {
    double time_limit_s; /* per child process */
    bool quiet;
};

/* Run all charts and add them to `charts` (the form of scripts/report/README.md). A series whose
 * engine is missing is left out, and the caption says so. */
enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 json_t *charts, struct neph_diag *diag);

#endif

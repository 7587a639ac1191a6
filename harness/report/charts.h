/* SPDX-License-Identifier: MIT
 *
 * Speed against accuracy: sweeps of one setting per series over a scene that has an exact answer.
 */
#ifndef NEPH_HARNESS_REPORT_CHARTS_H
#define NEPH_HARNESS_REPORT_CHARTS_H

#include "base/arena.h"
#include "harness/json.h"
#include "harness/progress.h"
#include "harness/run/speed.h"
#include "harness/run/store.h"

#include <stdbool.h>

struct neph_charts_params {
    const char *const *ids;            /* NULL-terminated; NULL: all */
    int repeats;                       /* renders of each point, 1 .. NEPH_CHARTS_REPEATS_MAX */
    struct neph_times *times;          /* of engines whose frames can be in flight, kept there */
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
};

enum { NEPH_CHARTS_REPEATS_MAX = 3 };

/* A chart of the report. Texts are of an arena. */
struct neph_chart {
    const char *id, *title, *caption;
    json_t *spec;        /* Vega-Lite with its data inside; owned */
    const char *svg;     /* inside the report; NULL: it is not drawn (yet) */
    const char *missing; /* why there is none; NULL: nothing is wrong */
    json_t *falls;       /* sentences: a series took less time for more work; owned */
};

/* Run charts into `*charts`, a list in the arena; `*count` grows with each one that is done. A
 * series whose engine is missing is left out, and the caption says so. */
enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 struct neph_progress *progress, struct neph_arena *arena,
                                 struct neph_chart **charts, int *count, struct neph_diag *diag);

/* As in scripts/report/README.md. */
json_t *neph_chart_json(const struct neph_chart *chart);

/* How many steps of progress that takes, and about how long one is for each repeat. */
int neph_charts_step_count(const struct neph_charts_params *params);
#define NEPH_CHARTS_STEP_TYPICAL_S 1.0

#endif

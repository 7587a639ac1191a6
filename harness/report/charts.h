/* SPDX-License-Identifier: MIT
 *
 * Charts of speed against accuracy in the report: for each engine a series over one setting, in a
 * scene with an exact reference.
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
    struct neph_times *times;          /* cached speeds of engines that render frames in flight */
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
};

enum { NEPH_CHARTS_REPEATS_MAX = 3 };

/* A chart of the report. Texts are allocated in an arena. */
struct neph_chart {
    const char *id, *title, *caption;
    json_t *spec;        /* Vega-Lite with its data inside; owned */
    const char *svg;     /* path inside the report; NULL: not drawn, or not yet */
    const char *missing; /* why there is no SVG; NULL: no problem */
    json_t *falls;       /* sentences about series in which more work took less time; owned */
};

/* Run charts. `*charts` is a list in the arena, and `*count` grows with each finished chart. A
 * series without its engine is left out, and the caption says so. */
enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 struct neph_progress *progress, struct neph_arena *arena,
                                 struct neph_chart **charts, int *count, struct neph_diag *diag);

/* As described in scripts/report/README.md. */
json_t *neph_chart_json(const struct neph_chart *chart);

/* The number of progress steps, and the typical duration of a step for each repeat. */
int neph_charts_step_count(const struct neph_charts_params *params);
#define NEPH_CHARTS_STEP_TYPICAL_S 1.0

#endif

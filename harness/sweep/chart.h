/* SPDX-License-Identifier: MIT
 *
 * The charts of a sweep: cost against error or flicker, and flicker against lag.
 */
#ifndef NEPH_HARNESS_SWEEP_CHART_H
#define NEPH_HARNESS_SWEEP_CHART_H

#include "harness/json.h"
#include "harness/sweep/results.h"

/* Quantities of the x axis. */
enum neph_sweep_axis {
    NEPH_SWEEP_AXIS_TIME, /* milliseconds per frame */
    NEPH_SWEEP_AXIS_WORK, /* density evaluations per pixel and frame */
    NEPH_SWEEP_AXIS_LAG,  /* frames until half of a step of the sun is shown */
    NEPH_SWEEP_AXIS_COUNT,
};

struct neph_sweep_chart {
    const char *id, *title;
    enum neph_sweep_axis x;
    enum neph_sweep_number y;
};

/* All charts in the order of the page; ends with a NULL id. */
extern const struct neph_sweep_chart neph_sweep_charts[];

/* Sizes of each chart: for a wide page, and for a phone. */
struct neph_sweep_chart_size {
    const char *name;
    int width_px, height_px, legend_columns;
};
enum { NEPH_SWEEP_CHART_SIZES = 2 };
extern const struct neph_sweep_chart_size neph_sweep_chart_sizes[NEPH_SWEEP_CHART_SIZES];

/* The specification of a chart, with its data, for json_decref(); NULL in `*spec` when the sweep
 * has no point to draw. Errors: NEPH_ERR_NOT_FOUND: no template; NEPH_ERR_MEMORY. */
enum neph_status neph_sweep_chart_spec(const struct neph_sweep *sweep,
                                       const struct neph_sweep_chart *chart,
                                       const struct neph_sweep_chart_size *size, json_t **spec,
                                       struct neph_diag *diag);

/* The caption: contents and omissions of a chart in a few sentences. The caller frees it. */
char *neph_sweep_chart_caption(const struct neph_sweep *sweep,
                               const struct neph_sweep_chart *chart);

#endif

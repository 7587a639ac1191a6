/* SPDX-License-Identifier: MIT
 *
 * The charts of a sweep: cost against what a point is off by, flicker against lag.
 */
#ifndef NEPH_HARNESS_SWEEP_CHART_H
#define NEPH_HARNESS_SWEEP_CHART_H

#include "harness/json.h"
#include "harness/sweep/results.h"

/* What stands on an axis. */
enum neph_sweep_axis {
    NEPH_SWEEP_AXIS_TIME, /* milliseconds of a picture */
    NEPH_SWEEP_AXIS_WORK, /* evaluations of density for a pixel of a picture */
    NEPH_SWEEP_AXIS_LAG,  /* frames to half of a step */
    NEPH_SWEEP_AXIS_COUNT,
};

struct neph_sweep_chart {
    const char *id, *title;
    enum neph_sweep_axis x;
    enum neph_sweep_number y;
};

/* All, in the order of the page; ends with a NULL id. */
extern const struct neph_sweep_chart neph_sweep_charts[];

/* Sizes in which each is drawn: for a page, and for a telephone. */
struct neph_sweep_chart_size {
    const char *name;
    int width_px, height_px, legend_columns;
};
enum { NEPH_SWEEP_CHART_SIZES = 2 };
extern const struct neph_sweep_chart_size neph_sweep_chart_sizes[NEPH_SWEEP_CHART_SIZES];

/* A specification with its data; NULL in `*spec` when the sweep has no point to draw. For the
 * caller to json_decref. Errors: NEPH_ERR_NOT_FOUND of the template; NEPH_ERR_MEMORY. */
enum neph_status neph_sweep_chart_spec(const struct neph_sweep *sweep,
                                       const struct neph_sweep_chart *chart,
                                       const struct neph_sweep_chart_size *size, json_t **spec,
                                       struct neph_diag *diag);

/* What is drawn, and what cannot be, in a sentence or two; for the caller to free. */
char *neph_sweep_chart_caption(const struct neph_sweep *sweep,
                               const struct neph_sweep_chart *chart);

#endif

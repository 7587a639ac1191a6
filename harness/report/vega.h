/* SPDX-License-Identifier: MIT
 *
 * Charts as Vega-Lite specifications, drawn by Node if it is installed.
 */
#ifndef NEPH_HARNESS_REPORT_VEGA_H
#define NEPH_HARNESS_REPORT_VEGA_H

#include "harness/json.h"

#include <stdbool.h>

/* Read a specification without its data, scripts/report/NAME; free it with json_decref(). */
enum neph_status neph_vega_template(const char *name, json_t **spec, struct neph_diag *diag);

/* Write STEM.vl.json. */
enum neph_status neph_vega_write(const json_t *spec, const char *stem, struct neph_diag *diag);

enum { NEPH_VEGA_CHARTS_MAX = 32 };

/* Draw STEM.svg for each STEM.vl.json, all with one start of Node, which takes longer than a chart.
 * `*drawn` is false when Node fails; `why`, never NULL, then has the reason, and the .log of the
 * first stem remains. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_vega_draw(char *const *stems, int count, bool *drawn, struct neph_diag *why,
                                struct neph_diag *diag);

#endif

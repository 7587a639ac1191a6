/* SPDX-License-Identifier: MIT
 *
 * Charts as Vega-Lite specifications, drawn by Node where it is installed.
 */
#ifndef NEPH_HARNESS_REPORT_VEGA_H
#define NEPH_HARNESS_REPORT_VEGA_H

#include "harness/json.h"

#include <stdbool.h>

/* A specification without its data, scripts/report/NAME; for the caller to json_decref. */
enum neph_status neph_vega_template(const char *name, json_t **spec, struct neph_diag *diag);

/* Write STEM.vl.json. */
enum neph_status neph_vega_write(const json_t *spec, const char *stem, struct neph_diag *diag);

enum { NEPH_VEGA_CHARTS_MAX = 32 };

/* From such files draw STEM.svg, all in one go: starting Node takes longer than a chart. Of a
 * failure the first one's .log stays. `*drawn` tells whether there are pictures; `why`, never NULL,
 * why not. Errors: NEPH_ERR_MEMORY; NEPH_ERR_INTERRUPTED. */
enum neph_status neph_vega_draw(char *const *stems, int count, bool *drawn, struct neph_diag *why,
                                struct neph_diag *diag);

#endif

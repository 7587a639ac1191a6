/* SPDX-License-Identifier: MIT
 *
 * A sweep as JSON and as a page with charts in two sizes, points, and the command of each point.
 * The page opens from disk without a network.
 */
#ifndef NEPH_HARNESS_SWEEP_OUTPUT_H
#define NEPH_HARNESS_SWEEP_OUTPUT_H

#include "harness/json.h"
#include "harness/sweep/results.h"

struct neph_report_folder;

/* The command line that renders a point. The caller frees it; NULL: out of memory. */
char *neph_sweep_command(const struct neph_sweep *sweep, const struct neph_sweep_point *point);

/* The device of the project's own engines: of the first rendered point of theirs; "": none. */
const char *neph_sweep_device(const struct neph_sweep *sweep);

/* Number of rendered points. */
int neph_sweep_measured_count(const struct neph_sweep *sweep);

/* The JSON described in scripts/report/README.md, for json_decref(); NULL: out of memory. */
json_t *neph_sweep_json(const struct neph_sweep *sweep);

/* Writes the page into an open folder (harness/report/report_folder.h). Without node the page has
 * no static charts; the page and `told` (one line, or "") say so. */
enum neph_status neph_sweep_page_write(const struct neph_sweep *sweep,
                                       const struct neph_report_folder *folder, char told[512],
                                       struct neph_diag *diag);

#endif

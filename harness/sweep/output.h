/* SPDX-License-Identifier: MIT
 *
 * A sweep as JSON and as a page: its charts in two sizes, its points, and how to make each again.
 * The page opens from disk without a network.
 */
#ifndef NEPH_HARNESS_SWEEP_OUTPUT_H
#define NEPH_HARNESS_SWEEP_OUTPUT_H

#include "harness/json.h"
#include "harness/sweep/results.h"

struct neph_report_folder;

/* The command line that renders a point by hand; for the caller to free, NULL when memory is
 * short. */
char *neph_sweep_command(const struct neph_sweep *sweep, const struct neph_sweep_point *point);

/* The device of our own renderer, by the first of its points that was rendered; "" when there is
 * none. */
const char *neph_sweep_device(const struct neph_sweep *sweep);

/* How many points were rendered. */
int neph_sweep_measured_count(const struct neph_sweep *sweep);

/* As in scripts/report/README.md; for the caller to json_decref, NULL when it could not be made. */
json_t *neph_sweep_json(const struct neph_sweep *sweep);

/* Put the page into an open folder (harness/report/report_folder.h). Without node the still charts
 * are missing, and the page and `told`, a line for people or "", say so. */
enum neph_status neph_sweep_page_write(const struct neph_sweep *sweep,
                                       const struct neph_report_folder *folder, char told[512],
                                       struct neph_diag *diag);

#endif

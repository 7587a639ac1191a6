/* SPDX-License-Identifier: MIT
 *
 * The page of a sweep: its charts in two sizes, its points, and how to make each again. It opens
 * from disk without a network.
 */
#ifndef NEPH_HARNESS_SWEEP_PAGE_H
#define NEPH_HARNESS_SWEEP_PAGE_H

#include "harness/sweep/results.h"

struct neph_report_folder;

/* Put it into an open folder (harness/report/report_folder.h). Without node the still charts are
 * missing, and the page and `told`, a line for people or "", say so. */
enum neph_status neph_sweep_page_write(const struct neph_sweep *sweep,
                                       const struct neph_report_folder *folder, char told[512],
                                       struct neph_diag *diag);

#endif

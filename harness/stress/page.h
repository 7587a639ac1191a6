/* SPDX-License-Identifier: MIT
 *
 * The page of the stress tests: a matrix of verdicts, and evidence of failures. It opens from disk
 * without a network. It can be published repeatedly during a run; each time it is replaced as a
 * whole (report/report_folder.h).
 */
#ifndef NEPH_HARNESS_STRESS_PAGE_H
#define NEPH_HARNESS_STRESS_PAGE_H

#include "harness/stress/results.h"

struct neph_report_folder;

struct neph_stress_page {
    struct neph_report_folder *folder; /* close with neph_report_folder_close() */
    size_t limit_bytes; /* limit of all files together: the worst cells get images first, and the
                           page has the number of cells without */
};

/* Prepares a page in `folder`, which must be free for it as for neph_report_open(). The caller sets
 * page->limit_bytes; all else is 0. */
enum neph_status neph_stress_page_open(const char *folder, struct neph_stress_page *page,
                                       struct neph_diag *diag);

/* Publishes the current state of the run. */
enum neph_status neph_stress_page_publish(const struct neph_stress_suite *suite,
                                          const struct neph_stress_page *page,
                                          struct neph_diag *diag);

#endif

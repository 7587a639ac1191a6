/* SPDX-License-Identifier: MIT
 *
 * The page of the stress tests: a matrix of verdicts, and the evidence of failures. It opens
 * from disk without a network, may be shown again and again while the run goes on, and is replaced
 * as a whole (report/report_folder.h).
 */
#ifndef NEPH_HARNESS_STRESS_PAGE_H
#define NEPH_HARNESS_STRESS_PAGE_H

#include "harness/stress/results.h"

struct neph_report_folder;

struct neph_stress_page {
    struct neph_report_folder *folder; /* ends with neph_report_folder_close() */
    size_t limit_bytes; /* of all files together: the worst cells have their images first, and the
                           page says how many have none */
};

/* Prepare a page at `folder`, which must be free for it, as of neph_report_open(). `page` is {0}
 * before but for its limit. */
enum neph_status neph_stress_page_open(const char *folder, struct neph_stress_page *page,
                                       struct neph_diag *diag);

/* Put the run as it is into the page. */
enum neph_status neph_stress_page_publish(const struct neph_stress_suite *suite,
                                          const struct neph_stress_page *page,
                                          struct neph_diag *diag);

#endif

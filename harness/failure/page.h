/* SPDX-License-Identifier: MIT
 *
 * The page of the failure suite: a matrix of verdicts, and the evidence of what fails. It opens
 * from disk without a network, may be shown again and again while the run goes on, and is replaced
 * as a whole (report/report_folder.h).
 */
#ifndef NEPH_HARNESS_FAILURE_PAGE_H
#define NEPH_HARNESS_FAILURE_PAGE_H

#include "harness/failure/results.h"

struct neph_failure_page;

/* Prepare a page at `folder`, which must be free for it, as of neph_report_open(). Its files are
 * not to take more than `limit_bytes` together: where pictures would, the worst cells have theirs
 * and the page says how many have not. Free with _close. */
enum neph_status neph_failure_page_open(const char *folder, size_t limit_bytes,
                                        struct neph_failure_page **page, struct neph_diag *diag);
void neph_failure_page_close(struct neph_failure_page *page);

/* Put the run as it is into the page: neph_failure_params.show, with the page as its context. */
enum neph_status neph_failure_page_publish(const struct neph_failure_suite *suite, void *page,
                                           struct neph_diag *diag);

#endif

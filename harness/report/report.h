/* SPDX-License-Identifier: MIT
 *
 * The report: a folder with an HTML page that opens from disk without a network. It is made only
 * from a validation and the stored frames that the validation names.
 *
 * The report can be published repeatedly while the validation grows. A reader sees either the old
 * report or the new one, never a mixture, even when several runs publish in the same folder: each
 * run works in its own temporary folders (.neph-report-*) and exchanges the report as a whole. The
 * last run wins.
 */
#ifndef NEPH_HARNESS_REPORT_REPORT_H
#define NEPH_HARNESS_REPORT_REPORT_H

#include "harness/report/validation.h"

struct neph_report;

/* Prepare a report at `folder`: a path that does not exist, an empty folder, or an earlier report
 * (base/owned.h); otherwise NEPH_ERR_USAGE before any work is done. Publishes nothing yet. Free
 * with neph_report_close(). */
enum neph_status neph_report_open(const char *folder, struct neph_report **report,
                                  struct neph_diag *diag);

/* Write the images, difference maps, charts, data and page of the validation's current state into a
 * new folder, and exchange that folder with the report. Images that exist are not drawn again. The
 * validation stores the names of its images, so it belongs to one report. Without Node the static
 * charts are missing, and the page says so. After a failure the previous report remains. */
enum neph_status neph_report_publish(struct neph_report *report, struct neph_validation *validation,
                                     struct neph_diag *diag);

/* The published report remains. NULL is allowed. */
void neph_report_close(struct neph_report *report);

#endif

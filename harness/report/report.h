/* SPDX-License-Identifier: MIT
 *
 * The report: one folder that opens from disk without a network. Made from a validation and the
 * frames in the store that it names, and from nothing else.
 *
 * It may be shown again and again while the validation grows. A reader sees the old report or the
 * new one, never half of one, also when several runs write to one folder: each works in folders of
 * its own beside it (.neph-report-*) and exchanges the whole; the last one stands.
 */
#ifndef NEPH_HARNESS_REPORT_REPORT_H
#define NEPH_HARNESS_REPORT_REPORT_H

#include "harness/report/validation.h"

struct neph_report;

/* Prepare a report at `folder`, which must be free for it (base/owned.h): not there, empty, or an
 * earlier report; else NEPH_ERR_USAGE, before any work is done. Shows nothing yet. Free with
 * neph_report_close. */
enum neph_status neph_report_open(const char *folder, struct neph_report **report,
                                  struct neph_diag *diag);

/* Put pictures, difference maps, charts, data and page of the validation as it is into a fresh
 * folder and exchange it with the report. Cheap to call again: what is drawn is not drawn again.
 * A validation is for one report alone, whose pictures it names. Without node the static charts are
 * missing, and the page says so. After a failure the report is the one before. */
enum neph_status neph_report_publish(struct neph_report *report, struct neph_validation *validation,
                                     struct neph_diag *diag);

/* What was published stays. NULL is fine. */
void neph_report_close(struct neph_report *report);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The report: one folder that opens from disk without a network. Made from the document of
 * neph_validate() and the frames in the store that it names, and from nothing else.
 */
#ifndef NEPH_HARNESS_REPORT_H
#define NEPH_HARNESS_REPORT_H

#include "base/status.h"
#include "harness/json.h"

/* Write pictures, difference maps, charts, data and page into a fresh folder and exchange it with
 * `folder` in one step: a reader sees the old report or the new one, never half of one. The paths
 * of pictures are set in `document`. Without node the static charts are missing, and the page says
 * so. */
enum neph_status neph_report_write(json_t *document, const char *folder, struct neph_diag *diag);

#endif

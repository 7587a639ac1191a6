/* SPDX-License-Identifier: MIT
 *
 * A scene over many frames, for the report: presets of the real-time renderer held against the
 * march of the same model, with the four frames of a cycle to look at.
 */
#ifndef NEPH_HARNESS_REPORT_OVER_TIME_H
#define NEPH_HARNESS_REPORT_OVER_TIME_H

#include "harness/json.h"
#include "harness/progress.h"
#include "harness/run/store.h"

/* Render and measure the sequence of the report and append it to `list` in the form of "sequences"
 * in scripts/report/README.md. A preset that fails is a row that says why. The store keeps the last
 * frame of each preset with its measurements and pictures, and they are used again. */
enum neph_status neph_over_time_run(struct neph_store *store, struct neph_progress *progress,
                                    json_t *list, struct neph_diag *diag);

/* Copy the pictures of the sequences from the store into images/over_time/ of a report's folder and
 * set their paths in the rows. */
enum neph_status neph_over_time_pictures(json_t *list, const char *report_folder,
                                         struct neph_diag *diag);

/* How many steps of progress that takes, and about how long one is on two cores. */
int neph_over_time_step_count(void);
#define NEPH_OVER_TIME_STEP_TYPICAL_S 8.0

#endif

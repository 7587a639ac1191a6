/* SPDX-License-Identifier: MIT
 *
 * `neph validate`: renders scenes with many engines, compares the frames with the highest reference
 * level, and evaluates the gates.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATE_H
#define NEPH_HARNESS_REPORT_VALIDATE_H

#include "harness/report/scene_run.h"

/* Run and measure. Returns NEPH_OK when gates fail as well: see the verdict. `validation` must be
 * {0} before; always free it with neph_validation_finish(). After NEPH_ERR_INTERRUPTED it contains
 * all finished results (if it has a title; otherwise nothing had started); their frames are in the
 * store, and a new run continues from there. */
enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               struct neph_validation *validation, struct neph_diag *diag);

#endif

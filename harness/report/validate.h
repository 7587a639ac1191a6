/* SPDX-License-Identifier: MIT
 *
 * The main job: scenes over engines, measured against the highest rung of truth, with gates.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATE_H
#define NEPH_HARNESS_REPORT_VALIDATE_H

#include "harness/report/scene_run.h"

/* Run and measure. NEPH_OK also when gates failed: the verdict says so. `validation`, {0} before,
 * is for neph_validation_finish() in any case. With NEPH_ERR_INTERRUPTED too everything finished is
 * in it (when it has a title; else nothing had begun) and in the store, and a new run goes on from
 * there. */
enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               struct neph_validation *validation, struct neph_diag *diag);

#endif

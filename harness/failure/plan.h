/* SPDX-License-Identifier: MIT
 *
 * What a run of the failure suite is made of: which scenarios, points and presets, and a row for
 * each number. Nothing is rendered.
 */
#ifndef NEPH_HARNESS_FAILURE_PLAN_H
#define NEPH_HARNESS_FAILURE_PLAN_H

#include "harness/failure/results.h"

/* Scenes, rows and columns of `suite`. Errors as of neph_failure_run(). */
enum neph_status neph_failure_plan(const struct neph_failure_params *params,
                                   struct neph_failure_suite *suite, struct neph_diag *diag);

/* Whether a number of a scenario is asked of a column. All are of a guest ("command"), of which
 * nobody knows what it is prone to; of a preset those of scenarios that name it, or none, or what
 * it is a change of. */
bool neph_failure_asks(const struct neph_failing *failing, const struct neph_failing_limit *limit,
                       const struct neph_failure_column *column);

#endif

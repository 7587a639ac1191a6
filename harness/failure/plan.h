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

/* Whether a scenario is of a preset: it names it, or none, or it is a change of one that it names;
 * or it is a guest ("command"), of which nobody knows what it is prone to. */
bool neph_failure_has_preset(const struct neph_failing *failing, const char *preset);

/* Whether a number of a scenario is asked of a column. */
bool neph_failure_asks(const struct neph_failing *failing, const struct neph_failing_limit *limit,
                       const struct neph_failure_column *column);

#endif

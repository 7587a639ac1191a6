/* SPDX-License-Identifier: MIT
 *
 * Runs a job within a time budget. External renderers cannot be paused and resumed, so one that
 * does not finish in time is started again with fewer samples, and the result notes the reduction.
 */
#ifndef NEPH_HARNESS_RUN_BUDGET_H
#define NEPH_HARNESS_RUN_BUDGET_H

#include "harness/run/job.h"

/* Like neph_job_run(), for a job whose child processes may each take `budget_s`.
 *
 * - A frame in the store is used first, the one with the most samples, so a repeated run costs no
 *   more than the first.
 * - A render that exceeds the budget is repeated with 1/8 of its samples, then with 1/64. Fixed
 *   sample counts give the same bits on every machine; a sampler stopped by the clock would not.
 * - `job->shot.settings` become the settings of the frame; result->note states the reduction.
 * - Where nothing fits, or the engine has no number of samples, the outcome is
 *   NEPH_OUTCOME_OVER_BUDGET. The reason gives time and noise, extrapolated from a frame of a
 *   quarter of the side.
 * - Where that frame does not finish either, the outcome is NEPH_OUTCOME_TIMEOUT: the engine may
 *   hang. */
enum neph_status neph_budget_run(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag);

/* The first step of neph_budget_run(): reuses a frame of the store, or renders with all samples. On
 * NEPH_OUTCOME_TIMEOUT call neph_budget_run(), which tries fewer samples. For worker processes that
 * share the cores: a timeout caused by the other workers reduces no samples. */
enum neph_status neph_budget_try(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A job within a budget of time: other people's renderers cannot be asked to rest and go on, so
 * that one which does not finish in time is asked for less, and what was given up is said.
 */
#ifndef NEPH_HARNESS_RUN_BUDGET_H
#define NEPH_HARNESS_RUN_BUDGET_H

#include "harness/run/job.h"

/* As neph_job_run() for a job whose child processes may each take `budget_s`. One that takes longer
 * is run again with an eighth of its samples, and once more with an eighth of those: settings that
 * give the same bits on every machine, where a sampler that is stopped by the clock would not.
 * `job->shot.settings` become those of the frame, and result->note says what was given up. When
 * nothing fits, or the engine has no samples to give up, the outcome is NEPH_OUTCOME_OVER_BUDGET
 * and the reason says what a picture of a quarter of the side tells of the time and the noise; when
 * not even that one ends, NEPH_OUTCOME_TIMEOUT: the engine may hang. The largest number of samples
 * that the store holds is taken before anything is rendered, so that a run is not dearer for being
 * repeated. */
enum neph_status neph_budget_run(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag);

/* The first step of that: reuse what the store holds, or render with all samples. With
 * NEPH_OUTCOME_TIMEOUT neph_budget_run() has more to try. For processes that share the cores with
 * others: none of them gives samples up because of the others. */
enum neph_status neph_budget_try(struct neph_job *job, double budget_s, struct neph_store *store,
                                 struct neph_job_result *result, struct neph_diag *diag);

#endif

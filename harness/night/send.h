/* SPDX-License-Identifier: MIT
 *
 * A nightly run on a Slurm cluster: one job for each unfinished step, on any host that mounts the
 * same folder, and one job that makes the report after all others have ended. Files record which
 * steps are done (jobs.h). So a failure of a host, of Slurm or of this process costs only the steps
 * in progress; the same command submits these steps again.
 *
 * Steps that measure durations need hosts that are marked for timing, and get them exclusively. All
 * steps of a run on a GPU need hosts that are marked to have one.
 */
#ifndef NEPH_HARNESS_NIGHT_SEND_H
#define NEPH_HARNESS_NIGHT_SEND_H

#include "harness/night/work.h"
#include "harness/run/slurm.h"

/* Submit the steps and wait for the report; `*id` is the number of the run. `words` are the
 * arguments of this command, NULL-terminated; each job gets them followed by --step NAME or
 * --report. While jobs of the same run are still queued or running, nothing is submitted and the
 * function only waits.
 *
 * - NEPH_ERR_UNAVAILABLE: there is no Slurm, or jobs of another run use the output folder.
 * - NEPH_ERR_USAGE: no hosts are named for a GPU run, or several hosts would share the store's
 *   database (run/index.h).
 * - NEPH_ERR_INTERRUPTED: the jobs were cancelled; the results of finished jobs are kept.
 * - NEPH_ERR_ENGINE: the jobs ended without a report. */
enum neph_status neph_night_send(const struct neph_night_params *params,
                                 const struct neph_slurm_settings *settings,
                                 const char *const *words, struct neph_store *store, int64_t *id,
                                 struct neph_diag *diag);

/* The job of one step: run the step unless it is done or its latest start has passed, and write its
 * numbers to a file. Opens no store. NEPH_ERR_USAGE: the step is not of a submitted run. */
enum neph_status neph_night_run_step(const struct neph_night_params *params, const char *step,
                                     struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A night that Slurm runs: a job for each step that is not done, on any host that has the same
 * folder, and one that ends the night when all of them have ended. Only files say what is done
 * (jobs.h), so that whatever becomes of a host, of Slurm or of this process costs the steps that
 * were at work and no other: the same command sends these anew.
 *
 * Steps that measure durations go to hosts that are marked for it alone, and have them for
 * themselves; all steps of a night on a GPU go to hosts that are marked to have one.
 */
#ifndef NEPH_HARNESS_NIGHT_SEND_H
#define NEPH_HARNESS_NIGHT_SEND_H

#include "harness/night/work.h"
#include "harness/run/slurm.h"

/* Hand the steps over and wait for the report; `*id` is the night. `words` are those of this
 * command, NULL-terminated, for the jobs to say again, with --step NAME or --report after them. A
 * night whose jobs are still there is waited for alone. NEPH_ERR_UNAVAILABLE: there is no Slurm, or
 * jobs of another night are at work in the output. NEPH_ERR_USAGE: its hosts are not told, or the
 * database of the store would be that of several hosts (run/index.h). NEPH_ERR_INTERRUPTED: the
 * jobs were cancelled, and what they had finished is kept. NEPH_ERR_ENGINE: they ended without a
 * report. */
enum neph_status neph_night_send(const struct neph_night_params *params,
                                 const struct neph_slurm_settings *settings,
                                 const char *const *words, struct neph_store *store, int64_t *id,
                                 struct neph_diag *diag);

/* What the job of a step does: run it, unless it is done or too late, and leave what it has
 * measured. Opens no store. NEPH_ERR_USAGE: it is no step of a night that was sent. */
enum neph_status neph_night_run_step(const struct neph_night_params *params, const char *step,
                                     struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The nightly run ("night" in names and files): it runs the steps of a plan as child commands,
 * stores their numbers in the store's history and compares them with the baseline, the last
 * accepted run. For the verb `neph nightly`.
 *
 * A run that was killed or interrupted continues with the next step, given the same plan, program
 * and revision.
 *
 * While the program is unchanged its frames come from the store. Each run repeats 2 % of the steps,
 * a different part of the plan every time, in an empty folder. A repeated step must reproduce its
 * numbers bit for bit.
 *
 * The executor of the steps is this process, one step after the other, or Slurm (send.h).
 */
#ifndef NEPH_HARNESS_NIGHT_NIGHT_H
#define NEPH_HARNESS_NIGHT_NIGHT_H

#include "harness/night/work.h"

/* Run the steps, compare the numbers, and store both. Returns NEPH_OK for a failed comparison as
 * well: the verdict is in `night->comparison`. NEPH_ERR_INTERRUPTED: finished steps are kept.
 * NEPH_ERR_UNAVAILABLE: another nightly run uses the folder. */
enum neph_status neph_night_run(const struct neph_night_params *params, struct neph_store *store,
                                struct neph_night *night, struct neph_diag *diag);
void neph_night_finish(struct neph_night *night);

#endif

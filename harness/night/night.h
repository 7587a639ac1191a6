/* SPDX-License-Identifier: MIT
 *
 * A night: steps of a plan, each run as a command of its own, their numbers kept in the store's
 * history, the whole compared with the accepted night. A night that was killed or interrupted goes
 * on where it stopped, with the same plan, program and revision.
 *
 * As long as the program is the same its frames are not rendered again, but for a step or two in
 * turn, which must give the same numbers to the last bit in an empty folder.
 *
 * Who runs the steps is the executor: this process, one after the other, or Slurm (send.h).
 */
#ifndef NEPH_HARNESS_NIGHT_NIGHT_H
#define NEPH_HARNESS_NIGHT_NIGHT_H

#include "harness/night/work.h"

/* Run, compare, and keep. NEPH_OK also when it does not pass: the comparison says so.
 * NEPH_ERR_INTERRUPTED: what was done is kept. NEPH_ERR_UNAVAILABLE: another night is at work in
 * the folder. */
enum neph_status neph_night_run(const struct neph_night_params *params, struct neph_store *store,
                                struct neph_night *night, struct neph_diag *diag);
void neph_night_finish(struct neph_night *night);

#endif

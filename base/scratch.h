/* SPDX-License-Identifier: MIT
 *
 * Folders for work in progress, in a folder that others may work in at the same time: a random name
 * (PARENT/PREFIX<16 hexadecimal digits>) and, beside it, a lock file of that name and ".lock" that
 * is held while the work goes on. What a killed run has left is known by its lock, which nobody
 * holds; so two containers, both with process number 1, do not take each other's for stale.
 * The lock file is there before the folder and goes after it.
 */
#ifndef NEPH_BASE_SCRATCH_H
#define NEPH_BASE_SCRATCH_H

#include "base/status.h"

#include <stdbool.h>

struct neph_scratch;

/* Make an empty folder inside `parent`, which must be there. Free with neph_scratch_destroy. */
enum neph_status neph_scratch_create(const char *parent, const char *prefix,
                                     struct neph_scratch **scratch, struct neph_diag *diag);

/* Where it is. Whoever wants to keep it renames it. */
const char *neph_scratch_path(const struct neph_scratch *scratch);

/* Remove the folder, if it is still there, and let go of it. */
void neph_scratch_destroy(struct neph_scratch *scratch);

/* Leave the folder where it is, for somebody who was told of it: nobody sweeps it any more. What it
 * holds is made to fit (neph_usage_trim()). An empty one is removed; whether it was kept. Frees. */
bool neph_scratch_keep(struct neph_scratch *scratch);

/* Remove what nobody works in any more. What cannot be removed stays for the next time. */
void neph_scratch_sweep(const char *parent, const char *prefix);

#endif

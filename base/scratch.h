/* SPDX-License-Identifier: MIT
 *
 * Scratch folders for unfinished work, inside a folder that several processes share. Each has a
 * random name (PARENT/PREFIX<16 hexadecimal digits>) and a lock file NAME.lock beside it, which is
 * locked while the work goes on. A folder whose lock is free was left by a killed process. Locks
 * also work between containers in which process numbers repeat. The lock file is created before the
 * folder and removed after it.
 */
#ifndef NEPH_BASE_SCRATCH_H
#define NEPH_BASE_SCRATCH_H

#include "base/status.h"

#include <stdbool.h>

struct neph_scratch;

/* Make an empty folder inside `parent`, which must exist. Free with neph_scratch_destroy(). */
enum neph_status neph_scratch_create(const char *parent, const char *prefix,
                                     struct neph_scratch **scratch, struct neph_diag *diag);

/* The path of the folder. A caller that keeps the folder renames it. */
const char *neph_scratch_path(const struct neph_scratch *scratch);

/* Remove the folder if it still exists, and release the lock. */
void neph_scratch_destroy(struct neph_scratch *scratch);

/* Keep the folder where it is, for the user, and free `scratch`. neph_scratch_sweep() no longer
 * removes the folder. Its contents are reduced to the limits of neph_usage_trim(). An empty folder
 * is removed. Returns whether the folder was kept. */
bool neph_scratch_keep(struct neph_scratch *scratch);

/* Remove the folders of processes that have ended. A folder that cannot be removed stays until the
 * next call. */
void neph_scratch_sweep(const char *parent, const char *prefix);

#endif

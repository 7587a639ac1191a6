/* SPDX-License-Identifier: MIT
 *
 * File locks by flock(2). The kernel releases them when their process ends, in whatever way. They
 * also work between containers that share a folder, where process numbers are not comparable.
 * Descriptors are closed on exec, so child processes inherit no lock.
 */
#ifndef NEPH_BASE_LOCK_H
#define NEPH_BASE_LOCK_H

#include "base/status.h"

/* Create the file `path` and lock it for as long as the returned descriptor is open. -1 and errno
 * on failure. EEXIST: the file exists, or another process took the new file for an abandoned one
 * before it was locked; try another name. On a file system without locks the file is unlocked, and
 * neph_lock_take_over() cannot take it over. */
int neph_lock_create(const char *path);

/* Take over a file whose creator has ended: a descriptor with the lock, or -1 when the file is
 * missing, is not a regular file, or is locked by a running process. */
int neph_lock_take_over(const char *path);

/* Create `path` if it is missing and wait for its lock; closing `*fd` releases it. For critical
 * sections of moments. The file stays. NEPH_ERR_IO also on a file system without locks. */
enum neph_status neph_lock_wait(const char *path, int *fd, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Locks on files by flock(2): they end with the process that holds them, however it ends, and hold
 * between containers that share a folder, where process numbers say nothing. All are closed on
 * exec: a child process holds none.
 */
#ifndef NEPH_BASE_LOCK_H
#define NEPH_BASE_LOCK_H

#include "base/status.h"

/* Make the file `path`, which must not be there, and lock it for as long as the returned descriptor
 * is open. -1 and errno on failure; EEXIST also when somebody took the new file for an abandoned
 * one before it was locked: try another name. A file system without locks gives an unlocked file,
 * which nobody can take over either. */
int neph_lock_create(const char *path);

/* Take over a file that its maker has left behind: a descriptor that holds the lock, or -1 when the
 * file is not there, is no regular file, or is held by somebody who lives. */
int neph_lock_take_over(const char *path);

/* Make `path` if need be and wait until it is ours; close `*fd` to let go. Meant to be held for
 * moments. The file stays. NEPH_ERR_IO also on a file system without locks. */
enum neph_status neph_lock_wait(const char *path, int *fd, struct neph_diag *diag);

#endif

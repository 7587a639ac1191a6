/* SPDX-License-Identifier: MIT
 *
 * Checkpoints: the sums of a long computation on disk, so that it can go on where it stopped. A
 * file is whole and of this very computation, or it is refused.
 *
 * Format: one line "neph-checkpoint 1 <identity bytes> <numbers> <BLAKE2b-256 of all that
 * follows>", the identity, then the numbers as IEEE doubles, least byte first.
 */
#ifndef NEPH_BASE_CHECKPOINT_H
#define NEPH_BASE_CHECKPOINT_H

#include "base/status.h"

#include <stddef.h>

/* Write under a temporary name and rename: an old checkpoint is lost only to a whole new one.
 * `identity` says in words what the numbers belong to (engine and version, scene hash, size, seed,
 * what each number is); all that may change between runs, such as a count of samples, is one of
 * the `values`. */
enum neph_status neph_checkpoint_write(const char *path, const char *identity, const double *values,
                                       size_t count, struct neph_diag *diag);

/* Read exactly `count` numbers; `values` is untouched on failure. NEPH_ERR_NOT_FOUND: no such file.
 * NEPH_ERR_INPUT: not a checkpoint, damaged, cut short, or of another identity (the message shows
 * both). */
enum neph_status neph_checkpoint_read(const char *path, const char *identity, double *values,
                                      size_t count, struct neph_diag *diag);

#endif

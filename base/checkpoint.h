/* SPDX-License-Identifier: MIT
 *
 * Checkpoints: files with the sums of a long computation, from which it can continue. A file that
 * is damaged, or belongs to another computation, is refused.
 *
 * Format: one line "neph-checkpoint 1 <identity bytes> <numbers> <BLAKE2b-256 of all bytes after
 * this line>", the identity, then the numbers as IEEE doubles, least significant byte first.
 */
#ifndef NEPH_BASE_CHECKPOINT_H
#define NEPH_BASE_CHECKPOINT_H

#include "base/status.h"

#include <stddef.h>

/* Write under a temporary name and rename: an old checkpoint is replaced only by a complete new
 * one. `identity` is a text that names the computation: engine and version, scene hash, size, seed,
 * the meaning of each number. A quantity that may change between runs, such as a sample count,
 * belongs into `values`. */
enum neph_status neph_checkpoint_write(const char *path, const char *identity, const double *values,
                                       size_t count, struct neph_diag *diag);

/* Read exactly `count` numbers; `values` is untouched on failure. NEPH_ERR_NOT_FOUND: no such file.
 * NEPH_ERR_INPUT: not a checkpoint, damaged, truncated, or of another identity (the message shows
 * both). */
enum neph_status neph_checkpoint_read(const char *path, const char *identity, double *values,
                                      size_t count, struct neph_diag *diag);

#endif

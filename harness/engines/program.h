/* SPDX-License-Identifier: MIT
 *
 * Other people's programs: a folder to run them in, how much they may write there, what they may
 * leave there, and which build of one is installed. A number of its version alone does not tell two
 * builds apart whose pictures differ in their last bits.
 */
#ifndef NEPH_HARNESS_ENGINES_PROGRAM_H
#define NEPH_HARNESS_ENGINES_PROGRAM_H

#include "base/child_result.h"
#include "base/scratch.h"
#include "base/usage.h"
#include "harness/engines/engine.h"

/* A folder in TMPDIR for a program that wants to write; what a run that was killed here has left
 * there is removed. `prefix` is that of all such folders. Free with neph_scratch_destroy(). */
enum neph_status neph_program_home(const char *prefix, struct neph_scratch **home,
                                   struct neph_diag *diag);

/* What a program may write into a folder for a picture of that size, beside what was `before` in
 * it: 512 MiB and 256 bytes a pixel (64 floats) on the disk, 16384 files and folders, and 16 MiB of
 * text. */
struct neph_child_limits neph_program_limits(const struct neph_usage *before, int width_px,
                                             int height_px);

/* Whether a program has left a file: something is at `path`. NEPH_ERR_ENGINE: it is a folder, a
 * pipe, a socket, a device, or a symbolic link that leads to none of these or to nothing. */
enum neph_status neph_program_left(const char *path, bool *is_left, struct neph_diag *diag);

/* The status of a program whose file could not be read with `status`: what is wrong with the file
 * is the program's failure, NEPH_ERR_ENGINE; an interrupt and a lack of memory are not. */
enum neph_status neph_program_status(enum neph_status status);

/* Ask `program` (in PATH) with --version, confined to a folder of its own (base/confine.h).
 * `*text` is what it says from the first `name` on, for the caller to free; `build` a digest of
 * that text and of the program's file. What a run that was killed here has left in TMPDIR is
 * removed. NEPH_ERR_IO: TMPDIR cannot be written. Else what neph_child_run() says. */
enum neph_status neph_program_ask(const char *program, const char *name, double time_limit_s,
                                  char **text, char build[NEPH_BUILD_SIZE], struct neph_diag *diag);

#endif

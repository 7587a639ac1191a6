/* SPDX-License-Identifier: MIT
 *
 * Other people's programs: a folder to run them in, and which build of one is installed. A number
 * of its version alone does not tell two builds apart whose pictures differ in their last bits.
 */
#ifndef NEPH_HARNESS_ENGINES_PROGRAM_H
#define NEPH_HARNESS_ENGINES_PROGRAM_H

#include "base/scratch.h"
#include "harness/engines/engine.h"

/* A folder in TMPDIR for a program that wants to write; what a run that was killed here has left
 * there is removed. `prefix` is that of all such folders. Free with neph_scratch_destroy(). */
enum neph_status neph_program_home(const char *prefix, struct neph_scratch **home,
                                   struct neph_diag *diag);

/* Ask `program` (in PATH) with --version. `*text` is what it says from the first `name` on, for the
 * caller to free; `build` a digest of that text and of the program's file. What a run that was
 * killed here has left in TMPDIR is removed. NEPH_ERR_IO: TMPDIR cannot be written. Else what
 * neph_child_run() says. */
enum neph_status neph_program_ask(const char *program, const char *name, double time_limit_s,
                                  char **text, char build[NEPH_BUILD_SIZE], struct neph_diag *diag);

#endif

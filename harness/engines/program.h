/* SPDX-License-Identifier: MIT
 *
 * Which build of a witness's program is installed. A number of its version alone does not tell two
 * builds apart whose pictures differ in their last bits.
 */
#ifndef NEPH_HARNESS_ENGINES_PROGRAM_H
#define NEPH_HARNESS_ENGINES_PROGRAM_H

#include "harness/engines/engine.h"

/* Ask `program` (in PATH) with --version. `*text` is what it says from the first `name` on, for the
 * caller to free; `build` a digest of that text and of the program's file. What a run that was
 * killed here has left in TMPDIR is removed. NEPH_ERR_IO: TMPDIR cannot be written. Else what
 * neph_child_run() says. */
enum neph_status neph_program_ask(const char *program, const char *name, double time_limit_s,
                                  char **text, char build[NEPH_BUILD_SIZE], struct neph_diag *diag);

#endif

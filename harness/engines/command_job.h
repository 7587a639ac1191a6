/* SPDX-License-Identifier: MIT
 *
 * Writes the input of engine `command` for a frame: job.json and depth.exr. docs/engines.md is the
 * contract; a change of keys changes NEPH_COMMAND_FORMAT.
 */
#ifndef NEPH_HARNESS_ENGINES_COMMAND_JOB_H
#define NEPH_HARNESS_ENGINES_COMMAND_JOB_H

#include "harness/engines/engine.h"

#define NEPH_COMMAND_FORMAT "neph-command-1"

/* Write both files of a frame into `folder`. `shot->scene` is the scene over time; `picture` is the
 * frame's index in the sequence, from 0. NEPH_ERR_INTERRUPTED, NEPH_ERR_IO. */
enum neph_status neph_command_job_write(const struct neph_engine *engine,
                                        const struct neph_shot *shot, int picture,
                                        const char *folder, struct neph_diag *diag);

#endif

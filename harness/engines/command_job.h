/* SPDX-License-Identifier: MIT
 *
 * What engine `command` hands to a program of the user's: a picture as job.json and depth.exr.
 * docs/engines.md is the contract; its keys change together with NEPH_COMMAND_FORMAT.
 */
#ifndef NEPH_HARNESS_ENGINES_COMMAND_JOB_H
#define NEPH_HARNESS_ENGINES_COMMAND_JOB_H

#include "harness/engines/engine.h"

#define NEPH_COMMAND_FORMAT "neph-command-1"

/* Write both files of a picture into `folder`. `shot->scene` is the scene over time; `picture`
 * counts those of the sequence, from 0. NEPH_ERR_INTERRUPTED, NEPH_ERR_IO. */
enum neph_status neph_command_job_write(const struct neph_engine *engine,
                                        const struct neph_shot *shot, int picture,
                                        const char *folder, struct neph_diag *diag);

#endif

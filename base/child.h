/* SPDX-License-Identifier: MIT
 *
 * Child processes: run a program without a shell, in its own process group, with a time limit, a
 * log file, and exact resource use of its own.
 */
#ifndef NEPH_BASE_CHILD_H
#define NEPH_BASE_CHILD_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct neph_child_params {
    const char *const *argv;        /* argv[0] is looked up in PATH; NULL-terminated */
    const char *working_directory;  /* NULL: unchanged */
    const char *log_path;           /* stdout and stderr go here (truncated); NULL: /dev/null */
    const char *const *environment; /* NULL: inherited; else the whole environment */
    double time_limit_s;            /* <= 0: none */
};

struct neph_child_result {
    int exit_code; /* valid when signal is 0 */
    int signal;    /* the signal that ended it, or 0 */
    double wall_s;
    double cpu_s;              /* user + system of the child and what it waited for */
    int64_t peak_memory_bytes; /* maximum resident set */
};

/* Run to the end. On time limit or neph_interrupted() the whole group gets SIGTERM, two seconds
 * later SIGKILL, and the status is NEPH_ERR_TIMEOUT or NEPH_ERR_INTERRUPTED. If neph itself dies,
 * even by SIGKILL, the child is killed too. NEPH_ERR_UNAVAILABLE: no such program.
 * NEPH_ERR_ENGINE: it ended with a non-zero exit code or a signal; the diag quotes the last lines
 * of its log. `result` is filled in every case in which the child has run. */
enum neph_status neph_child_run(const struct neph_child_params *params,
                                struct neph_child_result *result, struct neph_diag *diag);

/* True when `program` is an executable found in PATH (or is a path to one). */
bool neph_child_program_exists(const char *program);

#endif

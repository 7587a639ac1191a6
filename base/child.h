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
    const char *const *argv;        /* argv[0] is looked up in neph's PATH; NULL-terminated */
    const char *working_directory;  /* NULL: unchanged; does not move a relative argv[0] */
    const char *log_path;           /* stdout and stderr go here (truncated); NULL: /dev/null */
    const char *const *environment; /* NULL: inherited; else the whole environment */
    double time_limit_s;            /* <= 0: none */
};

struct neph_child_result {
    int exit_code; /* valid when signal is 0 */
    int signal;    /* the signal that ended it, or 0 */
    double wall_s;
    double cpu_s; /* user + system of the child and what it waited for */
    /* Maximum resident set of the child or of one process that it waited for. Exact when above
     * neph's own memory at the start; below it the kernel's number is neph's, and this is the
     * high-water mark of the child alone, sampled every 0.1 s. */
    int64_t peak_memory_bytes;
};

/* Run to the end, which is the end of the child: what is left of its group then gets SIGKILL. On
 * time limit or neph_interrupted() the whole group gets SIGTERM, two seconds later SIGKILL, and the
 * status is NEPH_ERR_TIMEOUT or NEPH_ERR_INTERRUPTED. If neph itself (or the thread that calls
 * this) dies, even by SIGKILL, the child is killed too; its own children are not. stdin is
 * /dev/null. NEPH_ERR_UNAVAILABLE: no such program, or not one that can be executed.
 * NEPH_ERR_ENGINE: it ended with a non-zero exit code or a signal; the diag quotes the last lines
 * of its log. NEPH_ERR_IO: no such working directory, or the log cannot be written. `result` is
 * filled in every case in which the child has run. May be called from several threads. */
enum neph_status neph_child_run(const struct neph_child_params *params,
                                struct neph_child_result *result, struct neph_diag *diag);

/* True when `program` is an executable found in PATH (or is a path to one). */
bool neph_child_program_exists(const char *program);

#endif

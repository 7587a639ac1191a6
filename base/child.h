/* SPDX-License-Identifier: MIT
 *
 * Child processes: run a program without a shell, in its own process group, with a time limit, a
 * log file, and exact resource use of its own.
 */
#ifndef NEPH_BASE_CHILD_H
#define NEPH_BASE_CHILD_H

#include "base/child_result.h"
#include "base/status.h"

#include <stdbool.h>

struct neph_child_params {
    const char *const *argv; /* argv[0] is looked up in neph's PATH; NULL-terminated */
    const char
        *working_directory; /* NULL: unchanged; moves neither a relative argv[0] nor `home` */
    const char *log_path;   /* stdout and stderr go here (truncated); NULL: /dev/null */
    /* The environment is made anew: PATH as neph has it, LANG=C.UTF-8, HOME and TMPDIR at `home`
     * (NULL: HOME=/nonexistent), then these "NAME=value" (NULL: none). Nothing else of the user's
     * environment reaches a child. */
    const char *home;
    bool is_confined; /* it and all that it starts change files in `working_directory` alone, where
                         the kernel can see to that (confine.h) */
    struct neph_child_limits limits; /* the first two need a `working_directory` */
    const char *const *environment;
    double time_limit_s; /* <= 0: none */
};

/* Run to the end, which is the end of the child: everything that it has started and left behind,
 * in whatever group or session, then gets SIGKILL and is gone when this returns. On time limit or
 * neph_interrupted() the child's group gets SIGTERM, two seconds later SIGKILL, and the status is
 * NEPH_ERR_TIMEOUT or NEPH_ERR_INTERRUPTED. If neph itself dies, even by SIGKILL, the child and
 * all beneath it are killed too. (To find what has left the group takes a kernel with
 * CONFIG_PROC_CHILDREN, as all distributions have it; without it the group alone is killed.) stdin
 * is /dev/null. NEPH_ERR_UNAVAILABLE: no such program, or not one that can be executed.
 * NEPH_ERR_ENGINE: it ended with a non-zero exit code or a signal, or was ended at one of its
 * limits, and then its log is cut there; the diag quotes the last lines of its log. NEPH_ERR_IO:
 * no such working directory, or the log cannot be written. `result` is filled in every case in
 * which the child has run and its end was seen. May be called from several threads. */
enum neph_status neph_child_run(const struct neph_child_params *params,
                                struct neph_child_result *result, struct neph_diag *diag);

/* What of this process's own environment a child may have, for `environment`: all but what is made
 * anew, and but variables that begin with one of `but` ("NAME=", NULL-terminated). At most `room`
 * entries, the last of which is NULL; -1: there are more. */
int neph_child_inherit(const char **variables, int room, const char *const *but);

/* The path of the file that argv[0] = `program` means, for the caller to free; NULL when there is
 * none that can be executed, or no memory. */
char *neph_child_find_program(const char *program);

/* True when `program` is an executable found in PATH (or is a path to one). */
bool neph_child_program_exists(const char *program);

#endif

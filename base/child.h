/* SPDX-License-Identifier: MIT
 *
 * Child processes: run a program without a shell, in its own process group, with a time limit, a
 * log file, and exact measurements of its own resource use.
 */
#ifndef NEPH_BASE_CHILD_H
#define NEPH_BASE_CHILD_H

#include "base/child_result.h"
#include "base/status.h"

#include <stdbool.h>

struct neph_child_params {
    const char *const *argv; /* argv[0] is looked up in neph's PATH; NULL-terminated */
    /* NULL: unchanged; moves neither a relative argv[0] nor `home` */
    const char *working_directory;
    const char *log_path; /* stdout and stderr go here (truncated); NULL: /dev/null */
    /* The child's environment has only: PATH of neph, LANG=C.UTF-8, HOME and TMPDIR set to `home`
     * (NULL: HOME=/nonexistent), and the entries "NAME=value" of `environment` (NULL: none). */
    const char *home;
    bool is_confined;                /* the child and all its descendants can change files only in
                                        `working_directory`, where the kernel can enforce it
                                        (confine.h) */
    struct neph_child_limits limits; /* limits of the folder need a `working_directory` */
    const char *const *environment;
    double time_limit_s; /* <= 0: none */
};

/* Run a program and return when it has ended. All its descendants that are still running then get
 * SIGKILL, in whatever process group or session they are; none is left when this returns.
 *
 *   cause                               action                             status
 *   time limit                          group: SIGTERM, 2 s later SIGKILL  NEPH_ERR_TIMEOUT
 *   neph_interrupted()                  group: SIGTERM, 2 s later SIGKILL  NEPH_ERR_INTERRUPTED
 *   death of neph, even by SIGKILL      child and descendants: SIGKILL     -
 *   program missing or not executable   -                                  NEPH_ERR_UNAVAILABLE
 *   exit code other than 0, a signal    -                                  NEPH_ERR_ENGINE
 *   a limit of `limits` exceeded        ended, log truncated at its limit  NEPH_ERR_ENGINE
 *   no such folder, log not writable    -                                  NEPH_ERR_IO
 *
 * With NEPH_ERR_ENGINE the diag quotes the last lines of the log. stdin is /dev/null. `result` is
 * filled whenever the child has run and its end was observed. May be called from several threads.
 *
 * Descendants outside the group are found through a kernel option that all distributions set,
 * CONFIG_PROC_CHILDREN; without it only the group is killed. */
enum neph_status neph_child_run(const struct neph_child_params *params,
                                struct neph_child_result *result, struct neph_diag *diag);

/* Variables of this process's environment that a child may inherit, as entries for `environment`.
 * Left out: variables that neph_child_run() sets itself, and variables that begin with an entry of
 * `but` ("NAME=", NULL-terminated). Writes at most `room` entries, the last of which is NULL, and
 * returns their number; -1: there are more. */
int neph_child_inherit(const char **variables, int room, const char *const *but);

/* The path of the executable file that argv[0] = `program` would run. The caller frees it. NULL
 * when no such file is executable, or memory is short. */
char *neph_child_find_program(const char *program);

/* True when `program` is an executable found in PATH (or is a path to one). */
bool neph_child_program_exists(const char *program);

#endif

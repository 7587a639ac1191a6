/* SPDX-License-Identifier: MIT
 *
 * The process that stands between neph and a program it runs, for child.c alone. It is there for
 * the one thing that neph cannot do: to end the program, and all that the program has started, when
 * neph itself has got SIGKILL. What a program leaves behind, in a session of its own too, becomes a
 * child of the keeper (PR_SET_CHILD_SUBREAPER), and so nothing escapes it.
 */
#ifndef NEPH_BASE_KEEPER_H
#define NEPH_BASE_KEEPER_H

#include "base/child_result.h"
#include "base/status.h"

#include <stdbool.h>

/* What the program is and gets. All is made before fork(): after it nothing may be allocated. */
struct neph_keeper_job {
    const char *program; /* absolute */
    char *const *argv;
    char *const *environment;
    const char *folder; /* NULL: unchanged */
    bool is_confined;   /* changes files in that folder alone */
    struct neph_child_limits limits;
    int input_fd, output_fd; /* stdin; stdout and stderr */
    int talk_fd;             /* the keeper's end of a SOCK_SEQPACKET pair; neph holds the other */
    double start_s;          /* as of neph_wall_s() */
    double time_limit_s;     /* <= 0: none */
};

/* How far the start came. */
enum neph_keeper_step {
    NEPH_KEEPER_READY,   /* everything is set, execve() is next; after it: the program has run */
    NEPH_KEEPER_SILENCE, /* the program's process was killed before it could say anything */
    NEPH_KEEPER_DEATH_SIGNAL,
    NEPH_KEEPER_GROUP,
    NEPH_KEEPER_FOLDER,
    NEPH_KEEPER_CONFINE,
    NEPH_KEEPER_FILES,
    NEPH_KEEPER_FORK,
    NEPH_KEEPER_EXEC,
};

/* The one message from the keeper to neph. */
struct neph_keeper_report {
    enum neph_keeper_step step; /* READY, or the step that failed with errno `error` */
    int error;
    enum neph_status ended_for; /* NEPH_OK, NEPH_ERR_TIMEOUT, NEPH_ERR_INTERRUPTED */
    enum neph_child_excess excess;
    struct neph_child_result result;
};

/* The life of the keeper; called after fork() with all signals blocked. Any byte from neph asks it
 * to end the program for an interrupt; a closed connection means that neph is dead, and then it
 * kills everything at once. It sends its report when nothing of the program is left. */
_Noreturn void neph_keeper_run(const struct neph_keeper_job *job);

#endif

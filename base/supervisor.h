/* SPDX-License-Identifier: MIT
 *
 * The child supervisor: a process between neph and a program that neph runs. Used only by child.c.
 * It ends the program and all its descendants, even after SIGKILL has ended neph itself.
 * Descendants that lose their parent, in any session, become children of the supervisor
 * (PR_SET_CHILD_SUBREAPER), so the supervisor finds all of them.
 */
#ifndef NEPH_BASE_SUPERVISOR_H
#define NEPH_BASE_SUPERVISOR_H

#include "base/child_result.h"
#include "base/status.h"

#include <stdbool.h>

/* The program and its limits. All of it is allocated before fork(): after fork() allocation is
 * unsafe. */
struct neph_supervisor_job {
    const char *program; /* absolute */
    char *const *argv;
    char *const *environment;
    const char *folder; /* NULL: unchanged */
    bool is_confined;   /* can change files only in that folder */
    struct neph_child_limits limits;
    int input_fd, output_fd; /* stdin; stdout and stderr */
    int connection_fd;       /* the supervisor's end of a SOCK_SEQPACKET pair with neph */
    double start_s;          /* as of neph_wall_s() */
    double time_limit_s;     /* <= 0: none */
};

/* The step of the start that was reached. */
enum neph_supervisor_step {
    NEPH_SUPERVISOR_READY,      /* set up, execve() is next; in a report: the program has run */
    NEPH_SUPERVISOR_NO_MESSAGE, /* the program's process was killed before it reported */
    NEPH_SUPERVISOR_DEATH_SIGNAL,
    NEPH_SUPERVISOR_GROUP,
    NEPH_SUPERVISOR_FOLDER,
    NEPH_SUPERVISOR_CONFINE,
    NEPH_SUPERVISOR_FILES,
    NEPH_SUPERVISOR_FORK,
    NEPH_SUPERVISOR_EXEC,
};

/* The only message from the supervisor to neph. */
struct neph_supervisor_report {
    enum neph_supervisor_step step; /* READY, or the step that failed with errno `error` */
    int error;
    enum neph_status ended_for; /* NEPH_OK, NEPH_ERR_TIMEOUT, NEPH_ERR_INTERRUPTED */
    enum neph_child_excess excess;
    struct neph_child_result result;
};

/* The main function of the supervisor; called after fork() with all signals blocked. Any byte from
 * neph is a request to end the program for an interrupt. A closed connection means that neph is
 * dead; all processes are then killed at once. The report is sent when no process of the program is
 * left. */
_Noreturn void neph_supervisor_run(const struct neph_supervisor_job *job);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Ctrl-C and SIGTERM as a flag that long work polls. The one process-wide state of the project: a
 * signal handler has nowhere else to put its news.
 */
#ifndef NEPH_BASE_INTERRUPT_H
#define NEPH_BASE_INTERRUPT_H

#include <stdbool.h>

/* Install the handlers. Call once, from main, before any thread or child. A second Ctrl-C ends the
 * program at once. A SIGINT that was ignored at the start (`neph &` in a script) stays ignored.
 * Also undoes an inherited SIG_IGN of SIGCHLD, which would lose the exit codes of children, and
 * ignores SIGXFSZ, so that a file that may not grow fails to be written (EFBIG). */
void neph_interrupt_install(void);

/* True once a signal has come that was not acknowledged. */
bool neph_interrupted(void);

/* The work has stopped: lower the flag, so that what is finished can be put in order by the same
 * functions that watch it. Another Ctrl-C still ends the program at once. */
void neph_interrupt_acknowledge(void);

/* A file descriptor that becomes readable when a signal comes, for poll(); -1 when not installed.
 */
int neph_interrupt_fd(void);

#endif

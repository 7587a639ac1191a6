/* SPDX-License-Identifier: MIT
 *
 * Ctrl-C and SIGTERM as a flag that long computations poll. This flag is the only global state of
 * the project: a signal handler has no other way to pass on a signal.
 */
#ifndef NEPH_BASE_INTERRUPT_H
#define NEPH_BASE_INTERRUPT_H

#include <stdbool.h>

/* Install the handlers. Call once, from main, before any thread or child. A second Ctrl-C ends the
 * program at once. A SIGINT that was ignored at the start (`neph &` in a script) stays ignored.
 * Also resets an inherited SIG_IGN of SIGCHLD, with which exit codes of children would be lost, and
 * ignores SIGXFSZ, so that writing beyond a file size limit fails with EFBIG. */
void neph_interrupt_install(void);

/* Whether a signal has arrived that was not acknowledged yet. */
bool neph_interrupted(void);

/* Clear the flag after the work has stopped, so that functions that poll it can be used to finish
 * results. Another Ctrl-C still ends the program at once. */
void neph_interrupt_acknowledge(void);

/* A file descriptor for poll() that becomes readable when a signal arrives; -1 when not installed.
 */
int neph_interrupt_fd(void);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A parallel loop over rows, on pthreads, and a function call with a time limit. In the loop each
 * index is processed by exactly one thread, so a body that writes only its own row gives the same
 * bits on any number of threads.
 */
#ifndef NEPH_BASE_THREADS_H
#define NEPH_BASE_THREADS_H

#include "base/status.h"

#include <stdbool.h>

/* Process one index. Called from several threads at a time. */
typedef void neph_row_body(int row, void *context);

/* Number of processors this process may use, at least 1. */
int neph_processor_count(void);

/* Number of threads of the loop below: the variable NEPH_THREADS of the environment, 1 to 1024, if
 * it is set, else neph_processor_count(). */
int neph_thread_count(void);

/* Set that variable. Call from main, before there are threads. */
void neph_set_thread_count(int count);

/* Call body(row, context) for row = 0 .. row_count-1. Stops early when interrupted, and then
 * returns NEPH_ERR_INTERRUPTED. Falls back to the calling thread when no thread can be made. */
enum neph_status neph_parallel_rows(int row_count, neph_row_body *body, void *context,
                                    struct neph_diag *diag);

/* Call work(context) on a new thread and wait for it for at most `limit_s` seconds. False: the call
 * has not returned, for example because a driver hangs. Nothing can end such a thread: it keeps
 * running, and the memory at `context` must stay valid from then on. */
bool neph_call_with_timeout(double limit_s, void (*work)(void *context), void *context);

#endif

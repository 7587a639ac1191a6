/* SPDX-License-Identifier: MIT
 *
 * One parallel loop over rows, on pthreads. Each index is worked on by exactly one thread, so a
 * body that writes only its own row gives the same bits on any number of threads. And a call that
 * is not waited for for ever.
 */
#ifndef NEPH_BASE_THREADS_H
#define NEPH_BASE_THREADS_H

#include "base/status.h"

#include <stdbool.h>

/* Work on one index. Called from several threads at a time. */
typedef void neph_row_body(int row, void *context);

/* Number of processors this process may use, at least 1. */
int neph_processor_count(void);

/* Call body(row, context) for row = 0 .. row_count-1. Stops early when interrupted, and then
 * returns NEPH_ERR_INTERRUPTED. Falls back to the calling thread when no thread can be made. */
enum neph_status neph_parallel_rows(int row_count, neph_row_body *body, void *context,
                                    struct neph_diag *diag);

/* Call work(context) on a thread of its own and wait for it for at most `limit_s` seconds. False:
 * it has not come back, as a driver that hangs does not; nothing can end it, so the thread and what
 * `context` points to are its own from then on and must stay. */
bool neph_finishes_within(double limit_s, void (*work)(void *context), void *context);

#endif

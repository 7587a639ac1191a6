/* SPDX-License-Identifier: MIT
 *
 * The message of a worker of a run to the process that shows the run: the cells of a column at a
 * point, and what they took.
 */
#ifndef NEPH_HARNESS_FAILURE_MESSAGE_H
#define NEPH_HARNESS_FAILURE_MESSAGE_H

#include "harness/failure/results.h"

struct neph_failure_message {
    int first_row, row_count, column; /* of the cells */
    int frame_count;                  /* of the take */
    double seconds;                   /* of the trial */
    int reference_count;              /* frames of the reference, made or found */
    double reference_s;
};

/* Write it, with the cells of `suite`, for the caller to free; NULL when memory is short. */
char *neph_failure_write_message(const struct neph_failure_message *message,
                                 const struct neph_failure_suite *suite);

/* Read it into the cells of `suite`, of the same plan. NEPH_ERR_INTERNAL: it is no message of such
 * a suite. */
enum neph_status neph_failure_read_message(const char *text, struct neph_failure_suite *suite,
                                           struct neph_failure_message *message,
                                           struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The trials of a run of the failure suite, one by one, and in which order they are begun.
 */
#ifndef NEPH_HARNESS_FAILURE_PIECES_H
#define NEPH_HARNESS_FAILURE_PIECES_H

#include "harness/failure/results.h"

/* A column at a point, of which something is asked. */
struct neph_failure_piece {
    int row, column; /* the first row of its point */
    bool is_later;   /* another of its point makes the truth of both */
    double cost;     /* samples along rays of all its frames, about */
};

/* Start from {0}; free the list. */
struct neph_failure_pieces {
    struct neph_failure_piece *list;
    int count;
};

/* All of a suite. For one process: from point to point, so that what is loaded serves several. For
 * several: what makes a truth before what needs it, so that nobody makes it twice, and what takes
 * long before what does not, so that in the end nobody is left alone with it. */
enum neph_status neph_failure_pieces_list(const struct neph_failure_suite *suite, bool are_spread,
                                          struct neph_failure_pieces *pieces,
                                          struct neph_diag *diag);

#endif

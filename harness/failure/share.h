/* SPDX-License-Identifier: MIT
 *
 * Work that goes through a store, spread over processes: each takes the next piece that nobody has
 * begun, and then one does the whole, which by then is only read. Nothing else goes from one to
 * another but how many steps are done, for the time left.
 */
#ifndef NEPH_HARNESS_FAILURE_SHARE_H
#define NEPH_HARNESS_FAILURE_SHARE_H

#include "base/status.h"

#include <stdbool.h>

struct neph_share_board;

/* The part of the process `index` of `count`; {0, 1}: the whole. */
struct neph_share {
    int index, count;
    bool again;                     /* the whole, after others have done it in parts */
    int next;                       /* of the whole */
    struct neph_share_board *board; /* of the parts */
};

/* The next piece of this process, from 0 on: each piece is one process's alone. */
int neph_share_next(struct neph_share *share);

/* Tell process 0 of steps of a kind (0 .. NEPH_PROGRESS_KINDS - 1) that are over, and hear there of
 * those since the last time. */
void neph_share_tell(const struct neph_share *share, int kind, int steps, double seconds);
void neph_share_hear(const struct neph_share *share, int kind, int *steps, double *seconds);

typedef enum neph_status neph_share_work(struct neph_share *share, void *context,
                                         struct neph_diag *diag);

/* With one job, the whole. With more, that many shares at the same time, this process being one of
 * them, and then the whole here: its status is what is returned, and what broke in another process
 * is met there again. No device may be open and no thread run before. When this process ends, so do
 * the others. */
enum neph_status neph_shares_run(int jobs, neph_share_work *work, void *context,
                                 struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Work that goes through a store, spread over processes: each does a share of it, and then one does
 * the whole, which by then is only read. Nothing else goes from one to another.
 */
#ifndef NEPH_HARNESS_FAILURE_SHARE_H
#define NEPH_HARNESS_FAILURE_SHARE_H

#include "base/status.h"

#include <stdbool.h>

/* The part of the process `index` of `count`; {0, 1}: the whole. */
struct neph_share {
    int index, count;
};

bool neph_share_has(const struct neph_share *share, int number);

typedef enum neph_status neph_share_work(const struct neph_share *share, void *context,
                                         struct neph_diag *diag);

/* With one job, the whole. With more, that many shares at the same time, this process being one of
 * them, and then the whole here: its status is what is returned, and what broke in another process
 * is met there again. No device may be open and no thread run before. When this process ends, so do
 * the others. */
enum neph_status neph_shares_run(int jobs, neph_share_work *work, void *context,
                                 struct neph_diag *diag);

#endif

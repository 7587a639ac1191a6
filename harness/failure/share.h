/* SPDX-License-Identifier: MIT
 *
 * Work that goes through a store, spread over processes: each takes the next piece that nobody has
 * begun, and tells of it in a text. This process renders nothing meanwhile, but hears all of them;
 * what nobody has told in the end it does itself.
 */
#ifndef NEPH_HARNESS_FAILURE_SHARE_H
#define NEPH_HARNESS_FAILURE_SHARE_H

#include "base/status.h"

struct neph_share_board;

/* The part of a process: `index` of 1 .. `count`; 0: of this one, the whole. */
struct neph_share {
    int index, count;
    int next;                       /* of the whole */
    struct neph_share_board *board; /* of the parts */
    int told_fd;                    /* of the parts */
};

/* The next piece of this process, from 0 on: of the parts each piece is one process's alone. */
int neph_share_next(struct neph_share *share);

/* Tell the process that hears; the whole has nobody to tell. A text that is too long is not told:
 * nor is what it says, then. */
enum { NEPH_SHARE_TEXT_MAX = 65536 };
void neph_share_tell(const struct neph_share *share, const char *text);

/* Pieces until there are none. */
typedef enum neph_status neph_share_work(struct neph_share *share, void *context,
                                         struct neph_diag *diag);

/* A text that a part has told, as soon as it has; NULL: none for a while. */
typedef enum neph_status neph_share_hear(const char *text, void *context, struct neph_diag *diag);

/* With one job, the whole. With more, that many parts at the same time in processes of their own,
 * which are heard here, and then the whole here, for what was not told: its status is what is
 * returned, and what ended another process is met there again. NEPH_ERR_INTERRUPTED. No device may
 * be open and no thread run before. When this process ends, so do the others. */
enum neph_status neph_shares_run(int jobs, neph_share_work *work, neph_share_hear *hear,
                                 void *context, struct neph_diag *diag);

#endif

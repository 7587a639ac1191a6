/* SPDX-License-Identifier: MIT
 *
 * Threads that work on what they are handed, in the order it comes, while who hands it in goes on.
 */
#ifndef NEPH_BASE_WORKERS_H
#define NEPH_BASE_WORKERS_H

#include "base/status.h"

#include <stdbool.h>

/* One piece of work, part of what it is about: owned by the caller, who lets it live until it is
 * done. Fill the first two. */
struct neph_task {
    void (*work)(void *context); /* on any thread */
    void *context;
    struct neph_task *next;
    bool is_done;
};

struct neph_workers;

/* At most `count` threads, each made when there is work for it. Free with _destroy. */
enum neph_status neph_workers_create(int count, struct neph_workers **workers,
                                     struct neph_diag *diag);

/* NULL is fine. All that was handed in is done before it returns. */
void neph_workers_destroy(struct neph_workers *workers);

/* Where no thread can be made the work is done before this returns. */
void neph_workers_add(struct neph_workers *workers, struct neph_task *task);

bool neph_workers_have_done(struct neph_workers *workers, const struct neph_task *task);

/* Wait for a task, or for all. What they wrote is seen afterwards. */
void neph_workers_wait(struct neph_workers *workers, const struct neph_task *task);
void neph_workers_wait_for_all(struct neph_workers *workers);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A pool of threads. Tasks are started in the order in which they are added, while the caller goes
 * on.
 */
#ifndef NEPH_BASE_WORKERS_H
#define NEPH_BASE_WORKERS_H

#include "base/status.h"

#include <stdbool.h>

/* A task: memory of the caller, valid until the task is done. Fill the first two fields. */
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

/* NULL is fine. All tasks that were added are done when it returns. */
void neph_workers_destroy(struct neph_workers *workers);

/* Where no thread can be made the task is done when this returns. */
void neph_workers_add(struct neph_workers *workers, struct neph_task *task);

bool neph_workers_have_done(struct neph_workers *workers, const struct neph_task *task);

/* Wait for a task, or for all. What they wrote is seen afterwards. */
void neph_workers_wait(struct neph_workers *workers, const struct neph_task *task);
void neph_workers_wait_for_all(struct neph_workers *workers);

#endif

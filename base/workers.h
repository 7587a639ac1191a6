/* SPDX-License-Identifier: MIT
 *
 * A pool of threads. Tasks are started in the order of neph_workers_add(), while the caller
 * continues.
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

/* At most `count` threads, each created when there is work for it. Free with _destroy. */
enum neph_status neph_workers_create(int count, struct neph_workers **workers,
                                     struct neph_diag *diag);

/* NULL is fine. Waits until all added tasks are done. */
void neph_workers_destroy(struct neph_workers *workers);

/* Where no thread can be created, the task is done when this returns. */
void neph_workers_add(struct neph_workers *workers, struct neph_task *task);

bool neph_workers_is_done(struct neph_workers *workers, const struct neph_task *task);

/* Wait for a task, or for all. Their writes are visible to the caller afterwards. */
void neph_workers_wait(struct neph_workers *workers, const struct neph_task *task);
void neph_workers_wait_for_all(struct neph_workers *workers);

#endif

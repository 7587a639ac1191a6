/* SPDX-License-Identifier: MIT
 *
 * A pool of worker processes. A job is an index; each worker takes the next one that is not taken,
 * and may send messages to the process that started the pool. Results do not travel: they lie in a
 * store (run/store.h), from which that process takes them in the end. What no worker has finished
 * it does itself.
 */
#ifndef NEPH_HARNESS_EXPERIMENT_POOL_H
#define NEPH_HARNESS_EXPERIMENT_POOL_H

#include "harness/engines/vulkan_device.h"

struct neph_pool_queue;

/* Worker `index` of 1 .. `count`, or, with index 0, the process itself, which does all jobs. */
struct neph_worker {
    int index, count;
    int next;                      /* job, of the process itself */
    struct neph_pool_queue *queue; /* of the workers; NULL: the process itself */
    int told_fd;                   /* of the workers */
};

/* The next job, from 0 on: each is given to one worker. The caller stops at its number of jobs. */
int neph_worker_next(struct neph_worker *worker);

/* Send a message; the process itself sends none. One that is too long is not sent. */
enum { NEPH_POOL_TEXT_MAX = 65536 };
void neph_worker_tell(const struct neph_worker *worker, const char *text);

/* Do jobs until there are none. */
typedef enum neph_status neph_pool_work(struct neph_worker *worker, void *context,
                                        struct neph_diag *diag);

/* A message, as soon as it arrives; NULL: none for a second. */
typedef enum neph_status neph_pool_hear(const char *text, void *context, struct neph_diag *diag);

/* With one worker, `work` in this process. With more, that many processes, whose messages are heard
 * here, and then `work` in this process, for what they have not done: its status is returned, and
 * an error of a worker is met again there. `hear` NULL: messages are dropped. NEPH_ERR_INTERRUPTED.
 * Each process opens the device for itself: workers start with `device` closed. No thread may run
 * before. Workers end with this process. */
enum neph_status neph_pool_run(int workers, struct neph_shared_device *device, neph_pool_work *work,
                               neph_pool_hear *hear, void *context, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A pool of worker processes. A job is an index. Each worker takes the next free job, and may send
 * messages to the process that started the pool. Results are not sent: workers put them into a
 * store (run/store.h), and the starting process reads them from there at the end. Jobs that no
 * worker has finished are done by the starting process.
 */
#ifndef NEPH_HARNESS_EXPERIMENT_POOL_H
#define NEPH_HARNESS_EXPERIMENT_POOL_H

#include "harness/engines/vulkan_device.h"

struct neph_pool_queue;

/* Worker `index` of 1 .. `count`. Index 0 is the starting process, which does all jobs. */
struct neph_worker {
    int index, count;
    int next;                      /* next job; only of the starting process */
    struct neph_pool_queue *queue; /* shared by the workers; NULL: the starting process */
    int message_fd;                /* for messages; only of workers */
};

/* Take the next job, from 0 on; each job is given to one worker. The caller stops at its number of
 * jobs. */
int neph_worker_take_job(struct neph_worker *worker);

/* Send a message to the starting process. A message of NEPH_POOL_TEXT_MAX bytes or more is not
 * sent; from the starting process nothing is sent. */
enum { NEPH_POOL_TEXT_MAX = 65536 };
void neph_worker_send_message(const struct neph_worker *worker, const char *text);

/* Do jobs until there are none left. */
typedef enum neph_status neph_pool_work(struct neph_worker *worker, void *context,
                                        struct neph_diag *diag);

/* Called with each message as soon as it arrives, and with NULL after a second without one. */
typedef enum neph_status neph_pool_receive(const char *text, void *context, struct neph_diag *diag);

/* Run `work` with `workers` workers. With one worker, `work` runs in this process. With more, that
 * many processes run it, and `hear` (NULL: none) gets their messages. Then `work` runs in this
 * process with index 0, for the jobs that are not done yet. Returned is the status of this last
 * call: an error of a worker occurs again there. NEPH_ERR_INTERRUPTED. Every worker opens the
 * device for itself: `device` is closed before workers start. No other thread may run at the call.
 * Workers end when this process ends. */
enum neph_status neph_pool_run(int workers, struct neph_shared_device *device, neph_pool_work *work,
                               neph_pool_receive *hear, void *context, struct neph_diag *diag);

#endif

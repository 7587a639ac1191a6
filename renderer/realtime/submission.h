/* SPDX-License-Identifier: MIT
 *
 * Records passes into command batches, as many as possible per submission. The targets that each
 * pass reads and writes decide where a barrier is needed.
 */
#ifndef NEPH_RENDERER_REALTIME_SUBMISSION_H
#define NEPH_RENDERER_REALTIME_SUBMISSION_H

#include "renderer/compute.h"
#include "renderer/realtime/passes.h"

/* Zero but for `vulkan`: nothing has been added. */
struct neph_rt_submission {
    const struct neph_vulkan *vulkan; /* borrowed */
    struct neph_batch batch;
    bool is_open;
    uint32_t reads, writes; /* targets since the last barrier */
};

/* Records a dispatch of a pass. */
enum neph_status neph_rt_submission_add(struct neph_rt_submission *submission,
                                        const struct neph_rt_pass *pass,
                                        const struct neph_kernel *kernel,
                                        const struct neph_dispatch *dispatch,
                                        struct neph_diag *diag);

/* Adds the device time since the last mark to `*gpu_s`: neph_batch_stamp(). */
void neph_rt_submission_mark(struct neph_rt_submission *submission, double *gpu_s);

/* Submits all recorded dispatches to the device. */
enum neph_status neph_rt_submission_submit(struct neph_rt_submission *submission,
                                           struct neph_diag *diag);

/* Submits them and waits for every submission so far. */
enum neph_status neph_rt_submission_wait(struct neph_rt_submission *submission,
                                         struct neph_diag *diag);

#endif

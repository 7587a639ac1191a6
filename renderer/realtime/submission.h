/* SPDX-License-Identifier: MIT
 *
 * Passes on their way to the device, as many as possible in one go: what they read and write says
 * where one must wait for another.
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
    uint32_t reads, writes; /* of the targets, since the last barrier */
};

/* Add a dispatch of a pass. */
enum neph_status neph_rt_submission_add(struct neph_rt_submission *submission,
                                        const struct neph_rt_pass *pass,
                                        const struct neph_kernel *kernel,
                                        const struct neph_dispatch *dispatch,
                                        struct neph_diag *diag);

/* The time on the device since the last such mark belongs to `*gpu_s`: neph_batch_stamp(). */
void neph_rt_submission_mark(struct neph_rt_submission *submission, double *gpu_s);

/* Send the device all that has been added. */
enum neph_status neph_rt_submission_send(struct neph_rt_submission *submission,
                                         struct neph_diag *diag);

/* Send it, and wait for all that was ever sent. */
enum neph_status neph_rt_submission_wait(struct neph_rt_submission *submission,
                                         struct neph_diag *diag);

#endif

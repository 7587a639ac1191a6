/* SPDX-License-Identifier: MIT
 *
 * Passes on their way to the device, as many as possible in one go: what they read and write says
 * where one must wait for another.
 */
#ifndef NEPH_RENDERER_REALTIME_SUBMISSION_H
#define NEPH_RENDERER_REALTIME_SUBMISSION_H

#include "renderer/compute.h"
#include "renderer/realtime/passes.h"

/* Zero but for `vulkan`: nothing is on its way. */
struct neph_rt_submission {
    const struct neph_vulkan *vulkan; /* borrowed */
    struct neph_batch batch;
    bool is_open;
    uint32_t reads, writes;               /* of the targets, since the last barrier */
    double *gpu_s[NEPH_BATCH_STAMPS_MAX]; /* borrowed; where the time before each stamp is added */
};

/* Add a dispatch of a pass. */
enum neph_status neph_rt_submission_add(struct neph_rt_submission *submission,
                                        const struct neph_rt_pass *pass,
                                        const struct neph_kernel *kernel,
                                        const struct neph_dispatch *dispatch,
                                        struct neph_diag *diag);

/* The time on the device since the last such mark belongs to `*gpu_s`, which the next _wait adds it
 * to (NaN when there is no clock; NULL: nobody wants it). */
void neph_rt_submission_mark(struct neph_rt_submission *submission, double *gpu_s);

/* Let the device do all that has been added, and wait for it. */
enum neph_status neph_rt_submission_wait(struct neph_rt_submission *submission,
                                         struct neph_diag *diag);

#endif

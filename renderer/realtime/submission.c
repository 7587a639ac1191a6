/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/submission.h"

/* A further bit for two buffers that are no targets: the ray states and counters of all passes with
 * rays, and the word that is bound for unused targets. A validation layer may take both for
 * written, so they need barriers. */
#define RAY_BUFFERS NEPH_RT_BIT(31)
_Static_assert(RT_TARGET_COUNT <= 31, "a bit for each target");

static void add_barrier(struct neph_rt_submission *submission, uint32_t reads, uint32_t writes)
{
    if ((reads & submission->writes) || (writes & (submission->reads | submission->writes))) {
        neph_batch_barrier(&submission->batch);
        submission->reads = submission->writes = 0;
    }
    submission->reads |= reads;
    submission->writes |= writes;
}

enum neph_status neph_rt_submission_add(struct neph_rt_submission *submission,
                                        const struct neph_rt_pass *pass,
                                        const struct neph_kernel *kernel,
                                        const struct neph_dispatch *dispatch,
                                        struct neph_diag *diag)
{
    if (!submission->is_open) {
        const enum neph_status status = neph_batch_begin(submission->vulkan, &submission->batch,
                                                         diag);
        if (status)
            return status;
        submission->is_open = true;
        submission->reads = submission->writes = 0;
    }
    add_barrier(submission, pass->reads | RAY_BUFFERS, pass->writes | RAY_BUFFERS);
    return neph_batch_dispatch(&submission->batch, kernel, dispatch, diag);
}

void neph_rt_submission_mark(struct neph_rt_submission *submission, double *gpu_s)
{
    if (submission->is_open)
        neph_batch_stamp(&submission->batch, gpu_s);
}

static const char what[] = "real-time passes";

enum neph_status neph_rt_submission_submit(struct neph_rt_submission *submission,
                                           struct neph_diag *diag)
{
    if (!submission->is_open)
        return NEPH_OK;
    submission->is_open = false;
    return neph_batch_submit(&submission->batch, what, diag);
}

enum neph_status neph_rt_submission_wait(struct neph_rt_submission *submission,
                                         struct neph_diag *diag)
{
    const enum neph_status status = neph_rt_submission_submit(submission, diag);
    return status ? status
                  : neph_batches_wait(submission->vulkan,
                                      neph_batches_submitted(submission->vulkan), what, diag);
}

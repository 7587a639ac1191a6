/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/watch.h"

#include "renderer/realtime/passes.h"

#include <string.h>

static const uint32_t code[] = {
#include "realtime/watch.comp.inc"
};

/* Targets with directions, which may be negative. */
#define SIGNED_TARGETS NEPH_RT_BIT(RT_MOVED)

enum { local_size = 64 }; /* of watch.comp */

uint32_t neph_rt_find_watched_targets(const struct neph_gpu_view *view)
{
    uint32_t found = 0;
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        for (int i = 0; i < NEPH_RT_HISTORIES_MAX && pass->histories[i].before; i++)
            found |= NEPH_RT_BIT(pass->histories[i].now);
    }
    return neph_rt_targets_used(view) & ~found;
}

static struct neph_gpu_watch_run make_watch_run(const struct neph_gpu_view *view, int target)
{
    const struct neph_rt_rectangle view_texels = neph_rt_view_texels(view, target);
    return (struct neph_gpu_watch_run){
        .format = view->targets[target].format,
        .row = view->targets[target].width,
        .left = view_texels.left,
        .top = view_texels.top,
        .width = view_texels.width,
        .height = view_texels.height,
        .is_signed = (SIGNED_TARGETS & NEPH_RT_BIT(target)) != 0,
    };
}

static enum neph_status watch_target(struct neph_rt_device *device,
                                     const struct neph_kernel *kernel, int target,
                                     struct neph_buffer *counter, struct neph_diag *diag)
{
    struct neph_gpu_watch_run run = make_watch_run(device->view, target);
    const uint32_t groups_max = device->vulkan->limits.maxComputeWorkGroupCount[0];
    const uint32_t texels = run.width * run.height;
    enum neph_status status = NEPH_OK;
    for (run.first = 0; run.first < texels && !status;) {
        const uint32_t groups = (texels - run.first + local_size - 1) / local_size;
        const struct neph_dispatch dispatch = {
            .buffers = {counter, &device->targets[target]},
            .push = &run,
            .group_count = groups < groups_max ? groups : groups_max,
        };
        status = neph_kernel_run(device->vulkan, kernel, &dispatch, NULL, diag);
        run.first += dispatch.group_count * local_size;
    }
    return status;
}

static enum neph_status watch_targets(struct neph_rt_device *device, uint32_t targets,
                                      struct neph_buffer *counter, struct neph_diag *diag)
{
    const struct neph_kernel_params params = {
        .name = "watch",
        .code = code,
        .code_bytes = sizeof(code),
        .buffer_count = 2,
        .push_size_bytes = sizeof(struct neph_gpu_watch_run),
    };
    const struct neph_kernel *kernel;
    enum neph_status status = neph_kernel_get(device->vulkan, &params, &kernel, diag);
    for (int t = 0; t < RT_TARGET_COUNT && !status; t++)
        if (targets & NEPH_RT_BIT(t) && neph_rt_device_words(device, t) > 0)
            status = watch_target(device, kernel, t, counter, diag);
    return status;
}

enum neph_status neph_rt_watch(struct neph_rt_device *device, uint32_t targets, uint64_t *bad,
                               struct neph_diag *diag)
{
    struct neph_buffer counter = {0};
    enum neph_status status = neph_batches_wait(
        device->vulkan, neph_batches_submitted(device->vulkan), "frames in flight", diag);
    if (!status)
        status = neph_buffer_create(device->vulkan, NEPH_BUFFER_UPLOAD, sizeof(uint32_t),
                                    "bad values", &counter, diag);
    if (status)
        return status;
    memset(counter.mapped, 0, counter.size_bytes);
    status = watch_targets(device, targets, &counter, diag);
    if (!status)
        *bad = *(const uint32_t *)counter.mapped;
    neph_buffer_destroy(device->vulkan, &counter);
    return status;
}

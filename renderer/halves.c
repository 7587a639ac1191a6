/* SPDX-License-Identifier: MIT */
#include "renderer/halves.h"

#include "shaders/structs.h"

#include <string.h>

static const uint32_t code[] = {
#include "shaders/halves.comp.inc"
};

enum { half_count = 1 << 16, local_size = 64 };

static enum neph_status run_halves_test(struct neph_vulkan *vulkan,
                                        const struct neph_buffer *verdict, struct neph_diag *diag)
{
    const struct neph_kernel_params params = {
        .name = "halves",
        .code = code,
        .code_bytes = sizeof(code),
        .buffer_count = 1,
    };
    const struct neph_dispatch dispatch = {
        .buffers = {verdict},
        .group_count = half_count / local_size,
    };
    const struct neph_kernel *kernel;
    memset(verdict->mapped, 0, verdict->size_bytes);
    const enum neph_status status = neph_kernel_get(vulkan, &params, &kernel, diag);
    return status ? status : neph_kernel_run(vulkan, kernel, &dispatch, NULL, diag);
}

enum neph_status neph_halves_test(struct neph_vulkan *vulkan, uint32_t *right,
                                  struct neph_diag *diag)
{
    struct neph_buffer verdict = {0};
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, sizeof(uint32_t),
                                                 "verdict on halves", &verdict, diag);
    if (!status)
        status = run_halves_test(vulkan, &verdict, diag);
    if (!status)
        *right = (NEPH_HALVES_READ | NEPH_HALVES_WRITTEN) & ~*(const uint32_t *)verdict.mapped;
    neph_buffer_destroy(vulkan, &verdict);
    return status;
}

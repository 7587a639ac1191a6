/* SPDX-License-Identifier: MIT */
#include "renderer/usable.h"

#include "renderer/compute.h"

bool neph_vulkan_is_usable(const struct neph_vulkan *vulkan)
{
    struct neph_batch batch;
    enum neph_status status = neph_vulkan_check(vulkan, NULL);
    if (!status)
        status = neph_batch_begin(vulkan, &batch, NULL);
    if (!status)
        status = neph_batch_submit(&batch, "an empty batch", NULL);
    if (!status)
        status = neph_batches_wait(vulkan, neph_batches_submitted(vulkan), "an empty batch", NULL);
    return status == NEPH_OK;
}

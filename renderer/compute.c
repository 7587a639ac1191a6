/* SPDX-License-Identifier: MIT */
#include "renderer/compute.h"

#include "renderer/device_memory.h"
#include "renderer/kernel_sets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new use: this file then needs a change. */
_Static_assert(NEPH_BUFFER_USE_COUNT == 3, "a new kind");

/* --- buffers ------------------------------------------------------------------------------ */

/* Memory properties of each use: needed, and preferred in addition. */
static const struct {
    VkBufferUsageFlags usage;
    VkMemoryPropertyFlags needed, liked;
} buffer_uses[] = {
    [NEPH_BUFFER_UPLOAD] = {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                            VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT},
    [NEPH_BUFFER_DEVICE] = {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT |
                                VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT},
    [NEPH_BUFFER_READBACK] = {VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                              VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                  VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                              VK_MEMORY_PROPERTY_HOST_CACHED_BIT},
};

/* The first memory type with all `properties`; UINT32_MAX: none. */
static uint32_t find_memory_type(const struct neph_vulkan *vulkan, uint32_t allowed_types,
                                 VkMemoryPropertyFlags properties)
{
    for (uint32_t i = 0; i < vulkan->memory.memoryTypeCount; i++)
        if ((allowed_types & (1u << i)) &&
            (vulkan->memory.memoryTypes[i].propertyFlags & properties) == properties)
            return i;
    return UINT32_MAX;
}

uint32_t neph_memory_type(const struct neph_vulkan *vulkan, uint32_t allowed_types,
                          VkMemoryPropertyFlags needed, VkMemoryPropertyFlags liked)
{
    const uint32_t type = find_memory_type(vulkan, allowed_types, needed | liked);
    return type == UINT32_MAX ? find_memory_type(vulkan, allowed_types, needed) : type;
}

static VkResult allocate_memory(const struct neph_vulkan *vulkan, enum neph_buffer_use use,
                                struct neph_buffer *buffer)
{
    VkMemoryRequirements requirements;
    vulkan->api.vkGetBufferMemoryRequirements(vulkan->device, buffer->handle, &requirements);
    const VkMemoryPropertyFlags needed = buffer_uses[use].needed;
    const uint32_t type = neph_memory_type(vulkan, requirements.memoryTypeBits, needed,
                                           buffer_uses[use].liked);
    if (type == UINT32_MAX)
        return VK_ERROR_FEATURE_NOT_PRESENT;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = requirements.size,
        .memoryTypeIndex = type,
    };
    VkResult result = vulkan->api.vkAllocateMemory(vulkan->device, &info, NULL, &buffer->memory);
    if (result == VK_SUCCESS)
        neph_device_memory_add(buffer->size_bytes);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkBindBufferMemory(vulkan->device, buffer->handle, buffer->memory, 0);
    if (result == VK_SUCCESS && (needed & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT))
        result = vulkan->api.vkMapMemory(vulkan->device, buffer->memory, 0, VK_WHOLE_SIZE, 0,
                                         &buffer->mapped);
    return result;
}

/* The smallest buffer for which neph_buffer_create_texel_views() can create views. */
enum { TEXEL_BYTES_MAX = 4 * sizeof(uint32_t) };

enum neph_status neph_buffer_create(const struct neph_vulkan *vulkan, enum neph_buffer_use use,
                                    size_t size_bytes, const char *name, struct neph_buffer *buffer,
                                    struct neph_diag *diag)
{
    if (size_bytes > vulkan->limits.maxStorageBufferRange)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "the buffer '%s' needs %zu bytes; the device allows %u", name, size_bytes,
                         vulkan->limits.maxStorageBufferRange);
    struct neph_buffer created = {.size_bytes = size_bytes};
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = size_bytes < TEXEL_BYTES_MAX ? TEXEL_BYTES_MAX : size_bytes,
        .usage = buffer_uses[use].usage,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
    };
    VkResult result = vulkan->api.vkCreateBuffer(vulkan->device, &info, NULL, &created.handle);
    if (result == VK_SUCCESS)
        result = allocate_memory(vulkan, use, &created);
    if (result != VK_SUCCESS) {
        neph_buffer_destroy(vulkan, &created);
        return neph_vulkan_fail(result, name, diag);
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_BUFFER, (uint64_t)created.handle, name);
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_DEVICE_MEMORY, (uint64_t)created.memory, name);
    *buffer = created;
    return NEPH_OK;
}

enum neph_status neph_buffer_create_texel_views(const struct neph_vulkan *vulkan,
                                                struct neph_buffer *buffer, struct neph_diag *diag)
{
    static const VkFormat formats[] = {VK_FORMAT_R32_UINT, VK_FORMAT_R32G32_UINT,
                                       VK_FORMAT_R32G32B32A32_UINT};
    _Static_assert(sizeof(formats) / sizeof(formats[0]) == NEPH_GPU_TEXEL_FORMATS, "a format each");
    const size_t words = buffer->size_bytes / sizeof(uint32_t);
    if (!vulkan->description.is_cpu)
        return NEPH_OK;
    if (words > vulkan->limits.maxTexelBufferElements)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a kernel needs %zu texels in one buffer; the device allows %u", words,
                         vulkan->limits.maxTexelBufferElements);
    for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++) {
        const VkBufferViewCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
            .buffer = buffer->handle,
            .format = formats[f],
            .range = VK_WHOLE_SIZE,
        };
        const VkResult result = vulkan->api.vkCreateBufferView(vulkan->device, &info, NULL,
                                                               &buffer->texels.formats[f]);
        if (result != VK_SUCCESS)
            return neph_vulkan_fail(result, "see texels", diag);
    }
    return NEPH_OK;
}

void neph_buffer_destroy(const struct neph_vulkan *vulkan, struct neph_buffer *buffer)
{
    if (buffer->handle)
        neph_kernel_sets_remove_buffer(vulkan, buffer->handle);
    for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++)
        vulkan->api.vkDestroyBufferView(vulkan->device, buffer->texels.formats[f], NULL);
    vulkan->api.vkDestroyBuffer(vulkan->device, buffer->handle, NULL);
    vulkan->api.vkFreeMemory(vulkan->device, buffer->memory, NULL); /* unmaps it too */
    if (buffer->memory)
        neph_device_memory_subtract(buffer->size_bytes);
    *buffer = (struct neph_buffer){0};
}

enum neph_status neph_buffers_create(const struct neph_vulkan *vulkan,
                                     const struct neph_buffer_row *rows, size_t row_count,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < row_count && !status; i++)
        status = neph_buffer_create(vulkan, rows[i].use, rows[i].size_bytes, rows[i].name,
                                    rows[i].buffer, diag);
    return status;
}

/* --- running ------------------------------------------------------------------------------ */

static void record_copy(const struct neph_vulkan *vulkan, const struct neph_lane *lane,
                        const struct neph_buffer *from, const struct neph_buffer *to,
                        size_t size_bytes)
{
    neph_lane_barrier(vulkan, lane, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                      VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                      VK_ACCESS_TRANSFER_READ_BIT);
    const VkBufferCopy region = {.size = size_bytes};
    vulkan->api.vkCmdCopyBuffer(lane->commands, from->handle, to->handle, 1, &region);
}

enum neph_status neph_batch_begin(const struct neph_vulkan *vulkan, struct neph_batch *batch,
                                  struct neph_diag *diag)
{
    *batch = (struct neph_batch){.vulkan = vulkan};
    const VkResult result = neph_lane_begin(vulkan, &batch->lane);
    if (result != VK_SUCCESS)
        batch->status = neph_vulkan_fail(result, "begin a batch", diag);
    return batch->status;
}

static void bind(struct neph_batch *batch, const struct neph_kernel *kernel, VkDescriptorSet set)
{
    const struct VolkDeviceTable *api = &batch->vulkan->api;
    const VkCommandBuffer commands = batch->lane->commands;
    if (kernel != batch->bound)
        api->vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->pipeline);
    if (set != batch->bound_set)
        api->vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->layout, 0, 1,
                                     &set, 0, NULL);
    batch->bound = kernel;
    batch->bound_set = set;
}

static struct neph_kernel_bound list_bindings(const struct neph_kernel *kernel,
                                              const struct neph_dispatch *dispatch)
{
    struct neph_kernel_bound bound = {.buffers = {VK_NULL_HANDLE}};
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params); i++) {
        bound.buffers[i] = dispatch->buffers[i]->handle;
        for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++)
            bound.texels[f][i] = dispatch->buffers[i]->texels.formats[f];
    }
    for (int i = 0; i < kernel->params.image_count; i++) {
        bound.images[i] = dispatch->images[i]->view;
        bound.samplers[i] = dispatch->images[i]->sampler;
    }
    return bound;
}

/* If a kernel is not compiled yet, submit the batch so far, so that the device can begin with it.
 */
static enum neph_status await_kernel(struct neph_batch *batch, const struct neph_kernel *kernel,
                                     struct neph_diag *diag)
{
    if (!neph_kernel_is_compiled(kernel) && batch->bound) {
        enum neph_status status = neph_batch_submit(batch, batch->bound->params.name, diag);
        if (!status)
            status = neph_batch_begin(batch->vulkan, batch, diag);
        if (status)
            return status;
    }
    return neph_kernel_finish(kernel, diag);
}

static enum neph_status record(struct neph_batch *batch, const struct neph_kernel *kernel,
                               const struct neph_dispatch *dispatch, struct neph_diag *diag)
{
    const struct VolkDeviceTable *api = &batch->vulkan->api;
    const enum neph_status status = await_kernel(batch, kernel, diag);
    if (status)
        return status;
    const uint32_t groups_max = batch->vulkan->limits.maxComputeWorkGroupCount[0];
    if (dispatch->group_count > groups_max)
        return neph_fail(
            diag, NEPH_ERR_UNSUPPORTED,
            "the kernel '%s' needs %u work groups in one dispatch; the device allows %u",
            kernel->params.name, dispatch->group_count, groups_max);
    VkDescriptorSet set;
    const struct neph_kernel_bound bound = list_bindings(kernel, dispatch);
    const VkResult result = neph_kernel_sets_get(kernel, &bound, &set);
    if (result != VK_SUCCESS)
        return neph_vulkan_fail(result, kernel->params.name, diag);
    bind(batch, kernel, set);
    const VkCommandBuffer commands = batch->lane->commands;
    if (kernel->params.push_size_bytes > 0)
        api->vkCmdPushConstants(commands, kernel->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                (uint32_t)kernel->params.push_size_bytes, dispatch->push);
    api->vkCmdDispatch(commands, dispatch->group_count, 1, 1);
    return NEPH_OK;
}

enum neph_status neph_batch_dispatch(struct neph_batch *batch, const struct neph_kernel *kernel,
                                     const struct neph_dispatch *dispatch, struct neph_diag *diag)
{
    if (!batch->status)
        batch->status = record(batch, kernel, dispatch, diag);
    return batch->status;
}

void neph_batch_barrier(struct neph_batch *batch)
{
    if (!batch->status)
        neph_lane_barrier(batch->vulkan, batch->lane, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                          VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                          VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void neph_batch_stamp(struct neph_batch *batch, double *seconds)
{
    if (!batch->status)
        neph_lane_stamp(batch->vulkan, batch->lane, seconds);
}

enum neph_status neph_batch_submit(struct neph_batch *batch, const char *what,
                                   struct neph_diag *diag)
{
    if (batch->status)
        return batch->status;
    const VkResult result = neph_lane_submit(batch->vulkan, batch->lane);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, what, diag);
}

enum neph_status neph_dispatch_submit(const struct neph_vulkan *vulkan,
                                      const struct neph_kernel *kernel,
                                      const struct neph_dispatch *dispatch, const char *what,
                                      double *gpu_s, struct neph_diag *diag)
{
    struct neph_batch batch;
    neph_batch_begin(vulkan, &batch, diag);
    neph_batch_dispatch(&batch, kernel, dispatch, diag);
    neph_batch_stamp(&batch, gpu_s);
    return neph_batch_submit(&batch, what, diag);
}

uint64_t neph_batches_submitted(const struct neph_vulkan *vulkan)
{
    return vulkan->lanes->sent;
}

enum neph_status neph_batches_wait(const struct neph_vulkan *vulkan, uint64_t count,
                                   const char *what, struct neph_diag *diag)
{
    const VkResult result = neph_lanes_wait(vulkan, count);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, what, diag);
}

enum neph_status neph_kernel_run(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                                 const struct neph_dispatch *dispatch, double *gpu_s,
                                 struct neph_diag *diag)
{
    struct neph_batch batch;
    double measured_s = 0.0;
    neph_batch_begin(vulkan, &batch, diag);
    enum neph_status status = neph_batch_dispatch(&batch, kernel, dispatch, diag);
    neph_batch_stamp(&batch, &measured_s);
    if (!status && dispatch->copy_to)
        record_copy(vulkan, batch.lane, dispatch->copy_from, dispatch->copy_to,
                    dispatch->copy_size_bytes);
    status = neph_batch_submit(&batch, kernel->params.name, diag);
    if (!status)
        status = neph_batches_wait(vulkan, neph_batches_submitted(vulkan), kernel->params.name,
                                   diag);
    if (!status && gpu_s)
        *gpu_s = measured_s;
    return status;
}

/* --- copies ------------------------------------------------------------------------------- */

/* Submit the recorded commands and wait for them. */
static VkResult run_lane(const struct neph_vulkan *vulkan, struct neph_lane *lane)
{
    const VkResult result = neph_lane_submit(vulkan, lane);
    return result == VK_SUCCESS ? neph_lanes_wait(vulkan, vulkan->lanes->sent) : result;
}

static VkResult upload_part(const struct neph_vulkan *vulkan, const struct neph_buffer *staging,
                            const struct neph_buffer *buffer, size_t offset_bytes,
                            size_t size_bytes)
{
    const VkBufferCopy region = {.dstOffset = offset_bytes, .size = size_bytes};
    struct neph_lane *lane;
    const VkResult result = neph_lane_begin(vulkan, &lane);
    if (result != VK_SUCCESS)
        return result;
    vulkan->api.vkCmdCopyBuffer(lane->commands, staging->handle, buffer->handle, 1, &region);
    return run_lane(vulkan, lane);
}

enum neph_status neph_buffer_upload(const struct neph_vulkan *vulkan,
                                    const struct neph_buffer *buffer, size_t offset_bytes,
                                    const void *data, size_t size_bytes, struct neph_diag *diag)
{
    const size_t chunk_max_bytes = (size_t)16 << 20;
    const size_t chunk_bytes = size_bytes < chunk_max_bytes ? size_bytes : chunk_max_bytes;
    struct neph_buffer staging = {0};
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, chunk_bytes, "staging",
                                                 &staging, diag);
    for (size_t done = 0; done < size_bytes && !status; done += chunk_bytes) {
        const size_t left = size_bytes - done;
        const size_t now = left < chunk_bytes ? left : chunk_bytes;
        memcpy(staging.mapped, (const char *)data + done, now);
        const VkResult result = upload_part(vulkan, &staging, buffer, offset_bytes + done, now);
        if (result != VK_SUCCESS)
            status = neph_vulkan_fail(result, "upload", diag);
    }
    neph_buffer_destroy(vulkan, &staging);
    return status;
}

/* The barrier makes the timestamp, which is one of kernels, wait for the copy. */
enum neph_status neph_copy_submit(const struct neph_vulkan *vulkan, const struct neph_buffer *from,
                                  const struct neph_buffer *to, size_t offset_bytes,
                                  size_t size_bytes, double *gpu_s, struct neph_diag *diag)
{
    const VkBufferCopy region = {.dstOffset = offset_bytes, .size = size_bytes};
    struct neph_lane *lane;
    VkResult result = neph_lane_begin(vulkan, &lane);
    if (result == VK_SUCCESS) {
        vulkan->api.vkCmdCopyBuffer(lane->commands, from->handle, to->handle, 1, &region);
        neph_lane_barrier(vulkan, lane, VK_PIPELINE_STAGE_TRANSFER_BIT,
                          VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                          VK_ACCESS_SHADER_READ_BIT);
        neph_lane_stamp(vulkan, lane, gpu_s);
        result = neph_lane_submit(vulkan, lane);
    }
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "copy", diag);
}

enum neph_status neph_buffer_download(const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer,
                                      const struct neph_buffer *readback, size_t size_bytes,
                                      struct neph_diag *diag)
{
    struct neph_lane *lane;
    VkResult result = neph_lane_begin(vulkan, &lane);
    if (result == VK_SUCCESS) {
        record_copy(vulkan, lane, buffer, readback, size_bytes);
        result = run_lane(vulkan, lane);
    }
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "download", diag);
}

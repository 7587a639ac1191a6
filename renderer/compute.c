/* SPDX-License-Identifier: MIT */
#include "renderer/compute.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- buffers ------------------------------------------------------------------------------ */

/* What each use needs of its memory, and what it would like on top. */
static const struct {
    VkBufferUsageFlags usage;
    VkMemoryPropertyFlags needed, liked;
} buffer_uses[] = {
    [NEPH_BUFFER_UPLOAD] = {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                            VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT},
    [NEPH_BUFFER_DEVICE] = {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT},
    [NEPH_BUFFER_READBACK] = {VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                              VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                  VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                              VK_MEMORY_PROPERTY_HOST_CACHED_BIT},
};

/* The first type that has the properties; UINT32_MAX when none has. */
static uint32_t find_memory_type(const struct neph_vulkan *vulkan, uint32_t allowed_types,
                                 VkMemoryPropertyFlags properties)
{
    for (uint32_t i = 0; i < vulkan->memory.memoryTypeCount; i++)
        if ((allowed_types & (1u << i)) &&
            (vulkan->memory.memoryTypes[i].propertyFlags & properties) == properties)
            return i;
    return UINT32_MAX;
}

static VkResult allocate_memory(const struct neph_vulkan *vulkan, enum neph_buffer_use use,
                                struct neph_buffer *buffer)
{
    VkMemoryRequirements requirements;
    vulkan->api.vkGetBufferMemoryRequirements(vulkan->device, buffer->handle, &requirements);
    const VkMemoryPropertyFlags needed = buffer_uses[use].needed;
    uint32_t type = find_memory_type(vulkan, requirements.memoryTypeBits,
                                     needed | buffer_uses[use].liked);
    if (type == UINT32_MAX)
        type = find_memory_type(vulkan, requirements.memoryTypeBits, needed);
    if (type == UINT32_MAX)
        return VK_ERROR_FEATURE_NOT_PRESENT;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = requirements.size,
        .memoryTypeIndex = type,
    };
    VkResult result = vulkan->api.vkAllocateMemory(vulkan->device, &info, NULL, &buffer->memory);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkBindBufferMemory(vulkan->device, buffer->handle, buffer->memory, 0);
    if (result == VK_SUCCESS && (needed & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT))
        result = vulkan->api.vkMapMemory(vulkan->device, buffer->memory, 0, VK_WHOLE_SIZE, 0,
                                         &buffer->mapped);
    return result;
}

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
        .size = size_bytes,
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

void neph_buffer_destroy(const struct neph_vulkan *vulkan, struct neph_buffer *buffer)
{
    vulkan->api.vkDestroyBuffer(vulkan->device, buffer->handle, NULL);
    vulkan->api.vkFreeMemory(vulkan->device, buffer->memory, NULL); /* unmaps it too */
    *buffer = (struct neph_buffer){0};
}

/* --- kernels ------------------------------------------------------------------------------ */

struct neph_kernel {
    struct neph_kernel *next;
    struct neph_kernel_params params; /* spirv not kept */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet set;
};

static void kernel_destroy(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    vulkan->api.vkDestroyDescriptorPool(vulkan->device, kernel->pool, NULL);
    vulkan->api.vkDestroyPipeline(vulkan->device, kernel->pipeline, NULL);
    vulkan->api.vkDestroyPipelineLayout(vulkan->device, kernel->layout, NULL);
    vulkan->api.vkDestroyDescriptorSetLayout(vulkan->device, kernel->set_layout, NULL);
    free(kernel);
}

void neph_kernels_destroy(struct neph_vulkan *vulkan)
{
    while (vulkan->kernels) {
        struct neph_kernel *kernel = vulkan->kernels;
        vulkan->kernels = kernel->next;
        kernel_destroy(vulkan, kernel);
    }
}

static int binding_count_of(const struct neph_kernel_params *params)
{
    return params->buffer_count + (params->array_count > 0 ? 1 : 0);
}

static VkResult create_layouts(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    VkDescriptorSetLayoutBinding bindings[NEPH_KERNEL_BUFFERS_MAX];
    const int array = kernel->params.buffer_count,
              binding_count = binding_count_of(&kernel->params);
    for (int i = 0; i < binding_count; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = (uint32_t)i,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    const VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = (uint32_t)binding_count,
        .pBindings = bindings,
    };
    const VkResult result = vulkan->api.vkCreateDescriptorSetLayout(vulkan->device, &set, NULL,
                                                                    &kernel->set_layout);
    if (result != VK_SUCCESS)
        return result;
    const VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = (uint32_t)kernel->params.push_size_bytes,
    };
    const VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &kernel->set_layout,
        .pushConstantRangeCount = push.size > 0 ? 1 : 0,
        .pPushConstantRanges = &push,
    };
    return vulkan->api.vkCreatePipelineLayout(vulkan->device, &layout, NULL, &kernel->layout);
}

static VkResult create_set(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    const VkDescriptorPoolSize size = {
        .type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        .descriptorCount = (uint32_t)(kernel->params.buffer_count + kernel->params.array_count),
    };
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = 1,
        .pPoolSizes = &size,
    };
    const VkResult result = vulkan->api.vkCreateDescriptorPool(vulkan->device, &pool, NULL,
                                                               &kernel->pool);
    if (result != VK_SUCCESS)
        return result;
    const VkDescriptorSetAllocateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = kernel->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &kernel->set_layout,
    };
    return vulkan->api.vkAllocateDescriptorSets(vulkan->device, &set, &kernel->set);
}

static VkResult create_pipeline(const struct neph_vulkan *vulkan, struct neph_kernel *kernel,
                                const struct neph_kernel_params *params)
{
    const VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = params->spirv_size_bytes,
        .pCode = params->spirv,
    };
    VkShaderModule module;
    VkResult result = vulkan->api.vkCreateShaderModule(vulkan->device, &module_info, NULL, &module);
    if (result != VK_SUCCESS)
        return result;

    VkSpecializationMapEntry entries[NEPH_KERNEL_CONSTANTS_MAX];
    for (int i = 0; i < params->constant_count; i++)
        entries[i] = (VkSpecializationMapEntry){
            .constantID = (uint32_t)i,
            .offset = (uint32_t)i * (uint32_t)sizeof(params->constants[0]),
            .size = sizeof(params->constants[0]),
        };
    const VkSpecializationInfo constants = {
        .mapEntryCount = (uint32_t)params->constant_count,
        .pMapEntries = entries,
        .dataSize = sizeof(params->constants),
        .pData = params->constants,
    };
    const VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &constants},
        .layout = kernel->layout,
    };
    result = vulkan->api.vkCreateComputePipelines(vulkan->device, VK_NULL_HANDLE, 1, &pipeline,
                                                  NULL, &kernel->pipeline);
    vulkan->api.vkDestroyShaderModule(vulkan->device, module, NULL);
    return result;
}

static bool same_kernel(const struct neph_kernel_params *a, const struct neph_kernel_params *b)
{
    return strcmp(a->name, b->name) == 0 && a->constant_count == b->constant_count &&
           memcmp(a->constants, b->constants,
                  (size_t)a->constant_count * sizeof(a->constants[0])) == 0;
}

enum neph_status neph_kernel_get(struct neph_vulkan *vulkan,
                                 const struct neph_kernel_params *params,
                                 const struct neph_kernel **kernel, struct neph_diag *diag)
{
    for (struct neph_kernel *known = vulkan->kernels; known; known = known->next)
        if (same_kernel(&known->params, params)) {
            *kernel = known;
            return NEPH_OK;
        }
    struct neph_kernel *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->params = *params;
    created->params.spirv = NULL;
    VkResult result = create_layouts(vulkan, created);
    if (result == VK_SUCCESS)
        result = create_set(vulkan, created);
    if (result == VK_SUCCESS)
        result = create_pipeline(vulkan, created, params);
    if (result != VK_SUCCESS) {
        kernel_destroy(vulkan, created);
        return neph_vulkan_fail(result, params->name, diag);
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE, (uint64_t)created->pipeline, params->name);
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE_LAYOUT, (uint64_t)created->layout,
                     params->name);
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_DESCRIPTOR_SET, (uint64_t)created->set, params->name);
    created->next = vulkan->kernels;
    vulkan->kernels = created;
    *kernel = created;
    return NEPH_OK;
}

/* --- running ------------------------------------------------------------------------------ */

static void bind_buffers(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                         const struct neph_dispatch *dispatch)
{
    VkDescriptorBufferInfo buffers[NEPH_KERNEL_BUFFERS_MAX];
    VkWriteDescriptorSet writes[NEPH_KERNEL_BUFFERS_MAX];
    const int array = kernel->params.buffer_count;
    const int binding_count = binding_count_of(&kernel->params);
    for (int i = 0; i < array + kernel->params.array_count; i++)
        buffers[i] = (VkDescriptorBufferInfo){.buffer = dispatch->buffers[i]->handle,
                                              .range = VK_WHOLE_SIZE};
    for (int i = 0; i < binding_count; i++)
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = kernel->set,
            .dstBinding = (uint32_t)i,
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pBufferInfo = &buffers[i],
        };
    vulkan->api.vkUpdateDescriptorSets(vulkan->device, (uint32_t)binding_count, writes, 0, NULL);
}

static void memory_barrier(const struct neph_vulkan *vulkan, VkPipelineStageFlags from_stage,
                           VkAccessFlags from_access, VkPipelineStageFlags to_stage,
                           VkAccessFlags to_access)
{
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = from_access,
        .dstAccessMask = to_access,
    };
    vulkan->api.vkCmdPipelineBarrier(vulkan->commands, from_stage, to_stage, 0, 1, &barrier, 0,
                                     NULL, 0, NULL);
}

static void record_copy(const struct neph_vulkan *vulkan, const struct neph_buffer *from,
                        const struct neph_buffer *to, size_t size_bytes)
{
    memory_barrier(vulkan, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    const VkBufferCopy region = {.size = size_bytes};
    vulkan->api.vkCmdCopyBuffer(vulkan->commands, from->handle, to->handle, 1, &region);
    memory_barrier(vulkan, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

/* What an error has left half recorded is dropped. */
static VkResult begin(const struct neph_vulkan *vulkan)
{
    const VkResult result = vulkan->api.vkResetCommandBuffer(vulkan->commands, 0);
    if (result != VK_SUCCESS)
        return result;
    const VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    return vulkan->api.vkBeginCommandBuffer(vulkan->commands, &info);
}

static VkResult submit_and_wait(const struct neph_vulkan *vulkan)
{
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &vulkan->commands,
    };
    VkResult result = vulkan->api.vkResetFences(vulkan->device, 1, &vulkan->fence);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkQueueSubmit(vulkan->queue, 1, &submit, vulkan->fence);
    if (result == VK_SUCCESS)
        result = vulkan->api.vkWaitForFences(vulkan->device, 1, &vulkan->fence, VK_TRUE,
                                             UINT64_MAX);
    return result;
}

static VkResult read_stamps(const struct neph_batch *batch, double seconds[])
{
    const struct neph_vulkan *vulkan = batch->vulkan;
    const uint32_t count = batch->stamp_count;
    uint64_t ticks[NEPH_BATCH_STAMPS_MAX + 1];
    for (uint32_t i = 0; i < count; i++)
        seconds[i] = NAN;
    if (!vulkan->timestamps || count == 0)
        return VK_SUCCESS;
    const VkResult result = vulkan->api.vkGetQueryPoolResults(
        vulkan->device, vulkan->timestamps, 0, count + 1, sizeof(ticks), ticks, sizeof(ticks[0]),
        VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++)
        seconds[i] = (double)((ticks[i + 1] - ticks[i]) & vulkan->timestamp_mask) *
                     vulkan->timestamp_period_s;
    return result;
}

enum neph_status neph_batch_begin(const struct neph_vulkan *vulkan, struct neph_batch *batch,
                                  struct neph_diag *diag)
{
    *batch = (struct neph_batch){.vulkan = vulkan};
    const VkResult result = begin(vulkan);
    if (result != VK_SUCCESS)
        return neph_vulkan_fail(result, "begin a batch", diag);
    if (vulkan->timestamps) {
        vulkan->api.vkCmdResetQueryPool(vulkan->commands, vulkan->timestamps, 0,
                                        NEPH_BATCH_STAMPS_MAX + 1);
        vulkan->api.vkCmdWriteTimestamp(vulkan->commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                                        vulkan->timestamps, 0);
    }
    return NEPH_OK;
}

void neph_batch_dispatch(struct neph_batch *batch, const struct neph_kernel *kernel,
                         const struct neph_dispatch *dispatch)
{
    const struct VolkDeviceTable *api = &batch->vulkan->api;
    const VkCommandBuffer commands = batch->vulkan->commands;
    if (kernel != batch->bound) {
        bind_buffers(batch->vulkan, kernel, dispatch);
        api->vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->pipeline);
        api->vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel->layout, 0, 1,
                                     &kernel->set, 0, NULL);
        batch->bound = kernel;
    }
    if (kernel->params.push_size_bytes > 0)
        api->vkCmdPushConstants(commands, kernel->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                (uint32_t)kernel->params.push_size_bytes, dispatch->push);
    api->vkCmdDispatch(commands, dispatch->group_count, 1, 1);
}

void neph_batch_barrier(struct neph_batch *batch)
{
    memory_barrier(batch->vulkan, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                   VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void neph_batch_stamp(struct neph_batch *batch)
{
    const struct neph_vulkan *vulkan = batch->vulkan;
    batch->stamp_count++;
    if (vulkan->timestamps)
        vulkan->api.vkCmdWriteTimestamp(vulkan->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                        vulkan->timestamps, batch->stamp_count);
}

/* Counters lie in memory that the CPU reads. */
enum neph_status neph_batch_run(struct neph_batch *batch, const char *what, double seconds[],
                                struct neph_diag *diag)
{
    memory_barrier(batch->vulkan, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    VkResult result = batch->vulkan->api.vkEndCommandBuffer(batch->vulkan->commands);
    if (result == VK_SUCCESS)
        result = submit_and_wait(batch->vulkan);
    if (result == VK_SUCCESS)
        result = read_stamps(batch, seconds);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, what, diag);
}

enum neph_status neph_kernel_run(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                                 const struct neph_dispatch *dispatch, double *gpu_s,
                                 struct neph_diag *diag)
{
    struct neph_batch batch;
    double measured_s;
    enum neph_status status = neph_batch_begin(vulkan, &batch, diag);
    if (status)
        return status;
    neph_batch_dispatch(&batch, kernel, dispatch);
    neph_batch_stamp(&batch);
    if (dispatch->copy_to)
        record_copy(vulkan, dispatch->copy_from, dispatch->copy_to, dispatch->copy_size_bytes);
    status = neph_batch_run(&batch, kernel->params.name, &measured_s, diag);
    if (!status && gpu_s)
        *gpu_s = measured_s;
    return status;
}

/* --- copies ------------------------------------------------------------------------------- */

static VkResult record_upload(const struct neph_vulkan *vulkan, const struct neph_buffer *staging,
                              const struct neph_buffer *buffer, size_t offset_bytes,
                              size_t size_bytes)
{
    const struct VolkDeviceTable *api = &vulkan->api;
    const VkResult result = begin(vulkan);
    if (result != VK_SUCCESS)
        return result;
    const VkBufferCopy region = {.dstOffset = offset_bytes, .size = size_bytes};
    api->vkCmdCopyBuffer(vulkan->commands, staging->handle, buffer->handle, 1, &region);
    memory_barrier(vulkan, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
    return api->vkEndCommandBuffer(vulkan->commands);
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
        VkResult result = record_upload(vulkan, &staging, buffer, offset_bytes + done, now);
        if (result == VK_SUCCESS)
            result = submit_and_wait(vulkan);
        if (result != VK_SUCCESS)
            status = neph_vulkan_fail(result, "upload", diag);
    }
    neph_buffer_destroy(vulkan, &staging);
    return status;
}

enum neph_status neph_buffer_download(const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer,
                                      const struct neph_buffer *readback, size_t size_bytes,
                                      struct neph_diag *diag)
{
    VkResult result = begin(vulkan);
    if (result == VK_SUCCESS) {
        record_copy(vulkan, buffer, readback, size_bytes);
        result = vulkan->api.vkEndCommandBuffer(vulkan->commands);
    }
    if (result == VK_SUCCESS)
        result = submit_and_wait(vulkan);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "download", diag);
}

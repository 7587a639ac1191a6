/* SPDX-License-Identifier: MIT */
#include "renderer/compute.h"

#include "renderer/device_memory.h"
#include "renderer/pipeline_cache.h"
#include "renderer/specialize.h"
#include "renderer/spirv_loops.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_BUFFER_USE_COUNT == 3, "a new kind");

/* --- buffers ------------------------------------------------------------------------------ */

/* What each use needs of its memory, and what it would like on top. */
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
        neph_device_memory_take(buffer->size_bytes);
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

enum neph_status neph_buffer_see_texels(const struct neph_vulkan *vulkan, int texel_words,
                                        struct neph_buffer *buffer, struct neph_diag *diag)
{
    static const VkFormat formats[] = {
        [1] = VK_FORMAT_R32_UINT, [2] = VK_FORMAT_R32G32_UINT, [4] = VK_FORMAT_R32G32B32A32_UINT};
    const VkBufferViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
        .buffer = buffer->handle,
        .format = formats[texel_words],
        .range = VK_WHOLE_SIZE,
    };
    const size_t texels = buffer->size_bytes / ((size_t)texel_words * sizeof(uint32_t));
    if (!vulkan->description.is_cpu)
        return NEPH_OK;
    if (texels > vulkan->limits.maxTexelBufferElements)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a kernel would have to see %zu texels; the device allows %u", texels,
                         vulkan->limits.maxTexelBufferElements);
    const VkResult result = vulkan->api.vkCreateBufferView(vulkan->device, &info, NULL,
                                                           &buffer->texels);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "see texels", diag);
}

static void forget_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer);

void neph_buffer_destroy(const struct neph_vulkan *vulkan, struct neph_buffer *buffer)
{
    if (buffer->handle)
        forget_buffer(vulkan, buffer->handle);
    vulkan->api.vkDestroyBufferView(vulkan->device, buffer->texels, NULL);
    vulkan->api.vkDestroyBuffer(vulkan->device, buffer->handle, NULL);
    vulkan->api.vkFreeMemory(vulkan->device, buffer->memory, NULL); /* unmaps it too */
    if (buffer->memory)
        neph_device_memory_give(buffer->size_bytes);
    *buffer = (struct neph_buffer){0};
}

/* --- kernels ------------------------------------------------------------------------------ */

struct neph_kernel {
    struct neph_kernel *next;
    struct neph_kernel_params params; /* spirv not kept */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    struct kernel_sets *sets; /* owned; grows where the kernel itself is const */
};

/* The buffers and images that a kernel has once been run with. */
struct kernel_set {
    struct kernel_set *next;
    VkBuffer buffers[NEPH_KERNEL_BUFFERS_MAX];
    VkImageView images[NEPH_KERNEL_IMAGES_MAX];
    VkDescriptorPool pool;
    VkDescriptorSet handle;
};

struct kernel_sets {
    struct kernel_set *first;
};

static int buffer_count_of(const struct neph_kernel *kernel)
{
    return kernel->params.buffer_count + kernel->params.array_count;
}

/* What goes: one of the two, or both null, which is everything. */
struct going {
    VkBuffer buffer;
    VkImageView image;
};

static bool set_has(const struct neph_kernel *kernel, const struct kernel_set *set,
                    struct going going)
{
    bool has = !going.buffer && !going.image;
    for (int i = 0; i < buffer_count_of(kernel); i++)
        has |= set->buffers[i] == going.buffer;
    for (int i = 0; i < kernel->params.image_count; i++)
        has |= set->images[i] == going.image;
    return has;
}

static void drop_sets(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                      struct going going)
{
    struct kernel_set **at = &kernel->sets->first;
    while (*at) {
        struct kernel_set *set = *at;
        if (!set_has(kernel, set, going)) {
            at = &set->next;
            continue;
        }
        *at = set->next;
        vulkan->api.vkDestroyDescriptorPool(vulkan->device, set->pool, NULL);
        free(set);
    }
}

static void kernel_destroy(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    if (kernel->sets)
        drop_sets(vulkan, kernel, (struct going){VK_NULL_HANDLE, VK_NULL_HANDLE});
    free(kernel->sets);
    vulkan->api.vkDestroyPipeline(vulkan->device, kernel->pipeline, NULL);
    vulkan->api.vkDestroyPipelineLayout(vulkan->device, kernel->layout, NULL);
    vulkan->api.vkDestroyDescriptorSetLayout(vulkan->device, kernel->set_layout, NULL);
    free(kernel);
}

/* Nothing that is on its way uses it any more, and another one may get its handle. */
static void forget(const struct neph_vulkan *vulkan, struct going going)
{
    neph_lanes_wait(vulkan, vulkan->lanes->sent); /* a lost device is reported by who needs it */
    for (struct neph_kernel *kernel = vulkan->kernels; kernel; kernel = kernel->next)
        drop_sets(vulkan, kernel, going);
}

static void forget_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer)
{
    forget(vulkan, (struct going){.buffer = buffer});
}

void neph_kernels_forget(const struct neph_vulkan *vulkan, const struct neph_texture *texture)
{
    forget(vulkan, (struct going){.image = texture->view});
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

static VkDescriptorType type_of(const struct neph_kernel_params *params, int binding)
{
    return binding < params->uniform_count ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                           : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

static VkResult create_layouts(const struct neph_vulkan *vulkan, struct neph_kernel *kernel)
{
    VkDescriptorSetLayoutBinding bindings[NEPH_KERNEL_BUFFERS_MAX + 2];
    const int array = kernel->params.buffer_count, image_count = kernel->params.image_count;
    int binding_count = binding_count_of(&kernel->params);
    for (int i = 0; i < binding_count; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = (uint32_t)i,
            .descriptorType = type_of(&kernel->params, i),
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    if (image_count > 0)
        bindings[binding_count++] = (VkDescriptorSetLayoutBinding){
            .binding = NEPH_GPU_IMAGES_BINDING,
            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
            .descriptorCount = (uint32_t)image_count,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    if (kernel->params.texels_count > 0)
        bindings[binding_count++] = (VkDescriptorSetLayoutBinding){
            .binding = NEPH_GPU_TEXELS_BINDING,
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
            .descriptorCount = (uint32_t)kernel->params.texels_count,
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

/* As a validation layer would: what lavapipe does not do as the shader says. */
static void check_loops(struct neph_vulkan *vulkan, const char *name, const uint32_t *words,
                        size_t size_bytes)
{
    struct neph_spirv_lost lost;
    if (!neph_spirv_find_lost(words, size_bytes, &lost) || !lost.value)
        return;
    if (vulkan->message_count++ == 0)
        snprintf(vulkan->first_message, sizeof(vulkan->first_message),
                 "shader %s: value %%%u of a turn of the loop at %%%u is asked for after the loop, "
                 "where lavapipe has lost it: carry it from turn to turn, or leave the loop at its "
                 "start (renderer/spirv_loops.h)",
                 name, lost.value, lost.header);
}

/* A shader that knows its constants: to lavapipe that is a third to a half of the work of a
 * pipeline, and the driver of an H100 took 25 s for the whole of march.comp. */
static VkResult create_module(struct neph_vulkan *vulkan, const struct neph_kernel_params *params,
                              VkShaderModule *module)
{
    uint32_t *specialized = NULL;
    size_t size_bytes = params->spirv_size_bytes;
    if (neph_specialize(params->spirv, params->spirv_size_bytes, params->constants,
                        params->constant_count, &specialized, &size_bytes, NULL))
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    if (vulkan->messenger && vulkan->description.is_cpu)
        check_loops(vulkan, params->name, specialized, size_bytes);
    const VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = size_bytes,
        .pCode = specialized ? specialized : params->spirv,
    };
    const VkResult result = vulkan->api.vkCreateShaderModule(vulkan->device, &info, NULL, module);
    free(specialized);
    return result;
}

static VkResult create_pipeline(struct neph_vulkan *vulkan, struct neph_kernel *kernel,
                                const struct neph_kernel_params *params)
{
    VkShaderModule module;
    VkResult result = create_module(vulkan, params, &module);
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
    result = vulkan->api.vkCreateComputePipelines(
        vulkan->device, neph_pipeline_cache_handle(vulkan), 1, &pipeline, NULL, &kernel->pipeline);
    vulkan->api.vkDestroyShaderModule(vulkan->device, module, NULL);
    return result;
}

/* Texels are a CPU's. Constants that a shader does not have become 0: they make no other kernel.
 * (Words and order as in the SPIR-V specification, 2.3 and 2.4: decorations come before the first
 * type.) */
static struct neph_kernel_params own_params(const struct neph_vulkan *vulkan,
                                            const struct neph_kernel_params *params)
{
    enum { HEADER_WORDS = 5, FIRST_TYPE = 19, LAST_TYPE = 39, OP_DECORATE = 71, SPEC_ID = 1 };
    struct neph_kernel_params own = *params;
    const uint32_t *words = params->spirv;
    const size_t count = params->spirv_size_bytes / sizeof(*words);
    own.texels_count = vulkan->description.is_cpu ? params->texels_count : 0;
    memset(own.constants, 0, sizeof(own.constants));
    for (size_t i = HEADER_WORDS; i < count; i += words[i] >> 16) {
        const uint32_t operation = words[i] & 0xffff;
        if (operation >= FIRST_TYPE && operation <= LAST_TYPE)
            break;
        if (operation == OP_DECORATE && words[i + 2] == SPEC_ID)
            own.constants[words[i + 3]] = params->constants[words[i + 3]];
    }
    return own;
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
    const struct neph_kernel_params own = own_params(vulkan, params);
    for (struct neph_kernel *known = vulkan->kernels; known; known = known->next)
        if (same_kernel(&known->params, &own)) {
            *kernel = known;
            return NEPH_OK;
        }
    struct neph_kernel *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->params = own;
    created->params.spirv = NULL;
    created->sets = calloc(1, sizeof(*created->sets));
    VkResult result = created->sets ? create_layouts(vulkan, created) : VK_ERROR_OUT_OF_HOST_MEMORY;
    if (result == VK_SUCCESS)
        result = create_pipeline(vulkan, created, &own);
    if (result != VK_SUCCESS) {
        kernel_destroy(vulkan, created);
        return neph_vulkan_fail(result, params->name, diag);
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE, (uint64_t)created->pipeline, params->name);
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_PIPELINE_LAYOUT, (uint64_t)created->layout,
                     params->name);
    created->next = vulkan->kernels;
    vulkan->kernels = created;
    *kernel = created;
    return NEPH_OK;
}

/* --- what a kernel is bound to ------------------------------------------------------------ */

static VkResult allocate_set(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                             struct kernel_set *set)
{
    const uint32_t uniforms = (uint32_t)kernel->params.uniform_count;
    VkDescriptorPoolSize sizes[4] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, (uint32_t)buffer_count_of(kernel) - uniforms},
    };
    uint32_t size_count = 1;
    if (uniforms > 0)
        sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, uniforms};
    if (kernel->params.image_count > 0)
        sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                                     (uint32_t)kernel->params.image_count};
    if (kernel->params.texels_count > 0)
        sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
                                                     (uint32_t)kernel->params.texels_count};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = size_count,
        .pPoolSizes = sizes,
    };
    const VkResult result = vulkan->api.vkCreateDescriptorPool(vulkan->device, &pool, NULL,
                                                               &set->pool);
    if (result != VK_SUCCESS)
        return result;
    const VkDescriptorSetAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = set->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &kernel->set_layout,
    };
    return vulkan->api.vkAllocateDescriptorSets(vulkan->device, &info, &set->handle);
}

static void write_images(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                         const struct kernel_set *set, const struct neph_dispatch *dispatch)
{
    VkDescriptorImageInfo images[NEPH_KERNEL_IMAGES_MAX];
    const int count = kernel->params.image_count;
    for (int i = 0; i < count; i++)
        images[i] = (VkDescriptorImageInfo){
            .sampler = dispatch->images[i]->sampler,
            .imageView = set->images[i],
            .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        };
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = set->handle,
        .dstBinding = NEPH_GPU_IMAGES_BINDING,
        .descriptorCount = (uint32_t)count,
        .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        .pImageInfo = images,
    };
    if (count > 0)
        vulkan->api.vkUpdateDescriptorSets(vulkan->device, 1, &write, 0, NULL);
}

static void write_texels(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                         const struct kernel_set *set, const struct neph_dispatch *dispatch)
{
    VkBufferView texels[NEPH_KERNEL_BUFFERS_MAX];
    const int count = kernel->params.texels_count;
    for (int i = 0; i < count; i++)
        texels[i] = dispatch->buffers[kernel->params.texels_first + i]->texels;
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = set->handle,
        .dstBinding = NEPH_GPU_TEXELS_BINDING,
        .descriptorCount = (uint32_t)count,
        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
        .pTexelBufferView = texels,
    };
    if (count > 0)
        vulkan->api.vkUpdateDescriptorSets(vulkan->device, 1, &write, 0, NULL);
}

static void write_set(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                      const struct kernel_set *set)
{
    VkDescriptorBufferInfo buffers[NEPH_KERNEL_BUFFERS_MAX];
    VkWriteDescriptorSet writes[NEPH_KERNEL_BUFFERS_MAX];
    const int array = kernel->params.buffer_count;
    const int binding_count = binding_count_of(&kernel->params);
    for (int i = 0; i < buffer_count_of(kernel); i++)
        buffers[i] = (VkDescriptorBufferInfo){.buffer = set->buffers[i], .range = VK_WHOLE_SIZE};
    for (int i = 0; i < binding_count; i++)
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set->handle,
            .dstBinding = (uint32_t)i,
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .descriptorType = type_of(&kernel->params, i),
            .pBufferInfo = &buffers[i],
        };
    vulkan->api.vkUpdateDescriptorSets(vulkan->device, (uint32_t)binding_count, writes, 0, NULL);
}

static bool is_for(const struct neph_kernel *kernel, const struct kernel_set *set,
                   const struct neph_dispatch *dispatch)
{
    bool same = true;
    for (int i = 0; i < buffer_count_of(kernel) && same; i++)
        same = set->buffers[i] == dispatch->buffers[i]->handle;
    for (int i = 0; i < kernel->params.image_count && same; i++)
        same = set->images[i] == dispatch->images[i]->view;
    return same;
}

/* Made once for the buffers and images of a dispatch, kept until one of them goes. */
static VkResult get_set(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                        const struct neph_dispatch *dispatch, VkDescriptorSet *handle)
{
    for (const struct kernel_set *set = kernel->sets->first; set; set = set->next)
        if (is_for(kernel, set, dispatch)) {
            *handle = set->handle;
            return VK_SUCCESS;
        }
    struct kernel_set *made = calloc(1, sizeof(*made));
    if (!made)
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    for (int i = 0; i < buffer_count_of(kernel); i++)
        made->buffers[i] = dispatch->buffers[i]->handle;
    for (int i = 0; i < kernel->params.image_count; i++)
        made->images[i] = dispatch->images[i]->view;
    made->next = kernel->sets->first;
    kernel->sets->first = made;
    const VkResult result = allocate_set(vulkan, kernel, made);
    if (result != VK_SUCCESS) {
        kernel->sets->first = made->next;
        vulkan->api.vkDestroyDescriptorPool(vulkan->device, made->pool, NULL);
        free(made);
        return result;
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_DESCRIPTOR_SET, (uint64_t)made->handle,
                     kernel->params.name);
    write_set(vulkan, kernel, made);
    write_images(vulkan, kernel, made, dispatch);
    write_texels(vulkan, kernel, made, dispatch);
    *handle = made->handle;
    return VK_SUCCESS;
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
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "begin a batch", diag);
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

enum neph_status neph_batch_dispatch(struct neph_batch *batch, const struct neph_kernel *kernel,
                                     const struct neph_dispatch *dispatch, struct neph_diag *diag)
{
    const struct VolkDeviceTable *api = &batch->vulkan->api;
    const VkCommandBuffer commands = batch->lane->commands;
    VkDescriptorSet set;
    const VkResult result = get_set(batch->vulkan, kernel, dispatch, &set);
    if (result != VK_SUCCESS)
        return neph_vulkan_fail(result, kernel->params.name, diag);
    bind(batch, kernel, set);
    if (kernel->params.push_size_bytes > 0)
        api->vkCmdPushConstants(commands, kernel->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                (uint32_t)kernel->params.push_size_bytes, dispatch->push);
    api->vkCmdDispatch(commands, dispatch->group_count, 1, 1);
    return NEPH_OK;
}

void neph_batch_barrier(struct neph_batch *batch)
{
    neph_lane_barrier(batch->vulkan, batch->lane, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                      VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                      VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void neph_batch_stamp(struct neph_batch *batch, double *seconds)
{
    neph_lane_stamp(batch->vulkan, batch->lane, seconds);
}

enum neph_status neph_batch_send(struct neph_batch *batch, const char *what, struct neph_diag *diag)
{
    const VkResult result = neph_lane_send(batch->vulkan, batch->lane);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, what, diag);
}

uint64_t neph_batches_sent(const struct neph_vulkan *vulkan)
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
    enum neph_status status = neph_batch_begin(vulkan, &batch, diag);
    if (!status)
        status = neph_batch_dispatch(&batch, kernel, dispatch, diag);
    if (status)
        return status;
    neph_batch_stamp(&batch, &measured_s);
    if (dispatch->copy_to)
        record_copy(vulkan, batch.lane, dispatch->copy_from, dispatch->copy_to,
                    dispatch->copy_size_bytes);
    status = neph_batch_send(&batch, kernel->params.name, diag);
    if (!status)
        status = neph_batches_wait(vulkan, neph_batches_sent(vulkan), kernel->params.name, diag);
    if (!status && gpu_s)
        *gpu_s = measured_s;
    return status;
}

/* --- copies ------------------------------------------------------------------------------- */

/* Send what has been recorded and wait for it. */
static VkResult run_lane(const struct neph_vulkan *vulkan, struct neph_lane *lane)
{
    const VkResult result = neph_lane_send(vulkan, lane);
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

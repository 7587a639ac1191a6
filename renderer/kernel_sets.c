/* SPDX-License-Identifier: MIT */
#include "renderer/kernel_sets.h"

#include "renderer/kernel.h"
#include "renderer/lane.h"

#include <stdlib.h>

/* The buffers and images that a kernel has once been run with. */
struct kernel_set {
    struct kernel_set *next;
    VkBuffer buffers[NEPH_KERNEL_BUFFERS_MAX];
    VkImageView images[NEPH_KERNEL_IMAGES_MAX];
    VkDescriptorPool pool;
    VkDescriptorSet handle;
};

struct neph_kernel_sets {
    struct kernel_set *first;
};

static void destroy_set(const struct neph_vulkan *vulkan, struct kernel_set *set)
{
    vulkan->api.vkDestroyDescriptorPool(vulkan->device, set->pool, NULL);
    free(set);
}

static VkResult allocate_set(const struct neph_vulkan *vulkan, const struct neph_kernel *kernel,
                             struct kernel_set *set)
{
    const uint32_t uniforms = (uint32_t)kernel->params.uniform_count;
    VkDescriptorPoolSize sizes[4] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
         (uint32_t)neph_kernel_buffer_count(&kernel->params) - uniforms},
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
    const int binding_count = neph_kernel_binding_count(&kernel->params);
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params); i++)
        buffers[i] = (VkDescriptorBufferInfo){.buffer = set->buffers[i], .range = VK_WHOLE_SIZE};
    for (int i = 0; i < binding_count; i++)
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set->handle,
            .dstBinding = (uint32_t)i,
            .descriptorCount = i == array ? (uint32_t)kernel->params.array_count : 1,
            .descriptorType = neph_kernel_binding_type(&kernel->params, i),
            .pBufferInfo = &buffers[i],
        };
    vulkan->api.vkUpdateDescriptorSets(vulkan->device, (uint32_t)binding_count, writes, 0, NULL);
}

static bool is_for(const struct neph_kernel *kernel, const struct kernel_set *set,
                   const struct neph_dispatch *dispatch)
{
    bool same = true;
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params) && same; i++)
        same = set->buffers[i] == dispatch->buffers[i]->handle;
    for (int i = 0; i < kernel->params.image_count && same; i++)
        same = set->images[i] == dispatch->images[i]->view;
    return same;
}

/* Made once for the buffers and images of a dispatch, kept until one of them goes. */
VkResult neph_kernel_sets_get(const struct neph_kernel *kernel,
                              const struct neph_dispatch *dispatch, VkDescriptorSet *handle)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    for (const struct kernel_set *set = kernel->sets->first; set; set = set->next)
        if (is_for(kernel, set, dispatch)) {
            *handle = set->handle;
            return VK_SUCCESS;
        }
    struct kernel_set *made = calloc(1, sizeof(*made));
    if (!made)
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params); i++)
        made->buffers[i] = dispatch->buffers[i]->handle;
    for (int i = 0; i < kernel->params.image_count; i++)
        made->images[i] = dispatch->images[i]->view;
    made->next = kernel->sets->first;
    kernel->sets->first = made;
    const VkResult result = allocate_set(vulkan, kernel, made);
    if (result != VK_SUCCESS) {
        kernel->sets->first = made->next;
        destroy_set(vulkan, made);
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

/* --- what goes ---------------------------------------------------------------------------- */

/* What goes: one of the two. */
struct going {
    VkBuffer buffer;
    VkImageView image;
};

static bool set_has(const struct neph_kernel *kernel, const struct kernel_set *set,
                    struct going going)
{
    bool has = false;
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params); i++)
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
        destroy_set(vulkan, set);
    }
}

struct neph_kernel_sets *neph_kernel_sets_create(void)
{
    return calloc(1, sizeof(struct neph_kernel_sets));
}

void neph_kernel_sets_destroy(const struct neph_vulkan *vulkan, struct neph_kernel_sets *sets)
{
    while (sets && sets->first) {
        struct kernel_set *set = sets->first;
        sets->first = set->next;
        destroy_set(vulkan, set);
    }
    free(sets);
}

/* Nothing that is on its way uses it any more, and another one may get its handle. */
static void forget(const struct neph_vulkan *vulkan, struct going going)
{
    neph_lanes_wait(vulkan, vulkan->lanes->sent); /* a lost device is reported by who needs it */
    for (struct neph_kernel *kernel = vulkan->kernels; kernel; kernel = kernel->next)
        drop_sets(vulkan, kernel, going);
}

void neph_kernels_forget_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer)
{
    forget(vulkan, (struct going){.buffer = buffer});
}

void neph_kernels_forget(const struct neph_vulkan *vulkan, const struct neph_texture *texture)
{
    forget(vulkan, (struct going){.image = texture->view});
}

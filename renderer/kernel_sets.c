/* SPDX-License-Identifier: MIT */
#include "renderer/kernel_sets.h"

#include "renderer/lane.h"

#include <stdlib.h>

struct kernel_set {
    struct kernel_set *next;
    const struct neph_kernel *kernel;
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
    VkDescriptorPoolSize sizes[3 + NEPH_GPU_TEXEL_FORMATS] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
         (uint32_t)neph_kernel_buffer_count(&kernel->params) - uniforms},
    };
    uint32_t size_count = 1;
    if (uniforms > 0)
        sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, uniforms};
    if (kernel->params.image_count > 0)
        sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                                     (uint32_t)kernel->params.image_count};
    for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++)
        if (kernel->params.texels_count[f] > 0)
            sizes[size_count++] = (VkDescriptorPoolSize){VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
                                                         (uint32_t)kernel->params.texels_count[f]};
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

static void write_images(const struct neph_kernel *kernel, const struct neph_kernel_bound *bound,
                         VkDescriptorSet set)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    VkDescriptorImageInfo images[NEPH_KERNEL_IMAGES_MAX];
    const int count = kernel->params.image_count;
    for (int i = 0; i < count; i++)
        images[i] = (VkDescriptorImageInfo){
            .sampler = bound->samplers[i],
            .imageView = bound->images[i],
            .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        };
    const VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = set,
        .dstBinding = NEPH_GPU_IMAGES_BINDING,
        .descriptorCount = (uint32_t)count,
        .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        .pImageInfo = images,
    };
    if (count > 0)
        vulkan->api.vkUpdateDescriptorSets(vulkan->device, 1, &write, 0, NULL);
}

static void write_texels(const struct neph_kernel *kernel, const struct neph_kernel_bound *bound,
                         VkDescriptorSet set)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    for (int f = 0; f < NEPH_GPU_TEXEL_FORMATS; f++) {
        const VkWriteDescriptorSet write = {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = (uint32_t)(NEPH_GPU_TEXELS_BINDING + f),
            .descriptorCount = (uint32_t)kernel->params.texels_count[f],
            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER,
            .pTexelBufferView = bound->texels[f] + kernel->params.texels_first,
        };
        if (write.descriptorCount > 0)
            vulkan->api.vkUpdateDescriptorSets(vulkan->device, 1, &write, 0, NULL);
    }
}

static void write_buffers(const struct neph_kernel *kernel, const struct neph_kernel_bound *bound,
                          VkDescriptorSet set)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    const struct neph_kernel_params *params = &kernel->params;
    VkDescriptorBufferInfo buffers[NEPH_KERNEL_BUFFERS_MAX];
    VkWriteDescriptorSet writes[NEPH_KERNEL_BUFFERS_MAX];
    const int array = params->buffer_count, binding_count = neph_kernel_binding_count(params);
    for (int i = 0; i < neph_kernel_buffer_count(params); i++)
        buffers[i] = (VkDescriptorBufferInfo){.buffer = bound->buffers[i], .range = VK_WHOLE_SIZE};
    for (int i = 0; i < binding_count; i++)
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = (uint32_t)i,
            .descriptorCount = i == array ? (uint32_t)params->array_count : 1,
            .descriptorType = neph_kernel_binding_type(params, i),
            .pBufferInfo = &buffers[i],
        };
    vulkan->api.vkUpdateDescriptorSets(vulkan->device, (uint32_t)binding_count, writes, 0, NULL);
}

static bool is_matching_set(const struct kernel_set *set, const struct neph_kernel *kernel,
                            const struct neph_kernel_bound *bound)
{
    bool same = set->kernel == kernel;
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params) && same; i++)
        same = set->buffers[i] == bound->buffers[i];
    for (int i = 0; i < kernel->params.image_count && same; i++)
        same = set->images[i] == bound->images[i];
    return same;
}

static struct kernel_set *make_set(const struct neph_kernel *kernel,
                                   const struct neph_kernel_bound *bound)
{
    struct kernel_set *made = calloc(1, sizeof(*made));
    if (!made)
        return NULL;
    made->kernel = kernel;
    for (int i = 0; i < neph_kernel_buffer_count(&kernel->params); i++)
        made->buffers[i] = bound->buffers[i];
    for (int i = 0; i < kernel->params.image_count; i++)
        made->images[i] = bound->images[i];
    return made;
}

VkResult neph_kernel_sets_get(const struct neph_kernel *kernel,
                              const struct neph_kernel_bound *bound, VkDescriptorSet *handle)
{
    const struct neph_vulkan *vulkan = kernel->vulkan;
    for (const struct kernel_set *set = vulkan->sets->first; set; set = set->next)
        if (is_matching_set(set, kernel, bound)) {
            *handle = set->handle;
            return VK_SUCCESS;
        }
    struct kernel_set *made = make_set(kernel, bound);
    const VkResult result = made ? allocate_set(vulkan, kernel, made) : VK_ERROR_OUT_OF_HOST_MEMORY;
    if (result != VK_SUCCESS) {
        if (made)
            destroy_set(vulkan, made);
        return result;
    }
    made->next = vulkan->sets->first;
    vulkan->sets->first = made;
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_DESCRIPTOR_SET, (uint64_t)made->handle,
                     kernel->params.name);
    write_buffers(kernel, bound, made->handle);
    write_images(kernel, bound, made->handle);
    write_texels(kernel, bound, made->handle);
    *handle = made->handle;
    return VK_SUCCESS;
}

/* --- removal of sets ---------------------------------------------------------------------- */

/* A destroyed resource, one of the two. Unused entries of a set are null. */
struct destroyed_resource {
    VkBuffer buffer;
    VkImageView image;
};

static bool is_in_set(const struct kernel_set *set, struct destroyed_resource destroyed_resource)
{
    bool has = false;
    for (int i = 0; i < NEPH_KERNEL_BUFFERS_MAX; i++)
        has |= destroyed_resource.buffer && set->buffers[i] == destroyed_resource.buffer;
    for (int i = 0; i < NEPH_KERNEL_IMAGES_MAX; i++)
        has |= destroyed_resource.image && set->images[i] == destroyed_resource.image;
    return has;
}

/* Wait for all users and destroy the sets; a new resource may get the same handle. */
static void remove_sets(const struct neph_vulkan *vulkan,
                        struct destroyed_resource destroyed_resource)
{
    neph_lanes_wait(vulkan, vulkan->lanes->sent); /* a lost device is reported by the next caller
                                                     that uses it */
    struct kernel_set **at = &vulkan->sets->first;
    while (*at) {
        struct kernel_set *set = *at;
        if (!is_in_set(set, destroyed_resource)) {
            at = &set->next;
            continue;
        }
        *at = set->next;
        destroy_set(vulkan, set);
    }
}

void neph_kernel_sets_remove_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer)
{
    remove_sets(vulkan, (struct destroyed_resource){.buffer = buffer});
}

void neph_kernel_sets_remove_image(const struct neph_vulkan *vulkan, VkImageView image)
{
    remove_sets(vulkan, (struct destroyed_resource){.image = image});
}

struct neph_kernel_sets *neph_kernel_sets_create(void)
{
    return calloc(1, sizeof(struct neph_kernel_sets));
}

void neph_kernel_sets_destroy(struct neph_vulkan *vulkan)
{
    while (vulkan->sets && vulkan->sets->first) {
        struct kernel_set *set = vulkan->sets->first;
        vulkan->sets->first = set->next;
        destroy_set(vulkan, set);
    }
    free(vulkan->sets);
    vulkan->sets = NULL;
}

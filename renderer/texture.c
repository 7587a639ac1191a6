/* SPDX-License-Identifier: MIT */
#include "renderer/texture.h"

#include "base/threads.h"
#include "renderer/device_memory.h"
#include "renderer/kernel_sets.h"
#include "renderer/realtime/view.h"
#include "renderer/shortcuts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new format: this file then needs a change. */
_Static_assert(NEPH_TEXEL_FORMAT_COUNT == 3, "a new kind");

static const struct {
    VkFormat format;
    size_t bytes;
} formats[] = {
    [NEPH_TEXEL_R32F] = {VK_FORMAT_R32_SFLOAT, 4},
    [NEPH_TEXEL_R16F] = {VK_FORMAT_R16_SFLOAT, 2},
    [NEPH_TEXEL_R8] = {VK_FORMAT_R8_UNORM, 1},
};

/* --- device support ----------------------------------------------------------------------- */

bool neph_texture_filters(const struct neph_vulkan *vulkan, enum neph_texel_format format)
{
    const VkFormatFeatureFlags needed = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
                                        VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT |
                                        VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(vulkan->physical_device, formats[format].format,
                                        &properties);
    return (properties.optimalTilingFeatures & needed) == needed;
}

static enum neph_status check(const struct neph_vulkan *vulkan,
                              const struct neph_texture_params *params, struct neph_diag *diag)
{
    const int most = (int)vulkan->limits.maxImageDimension3D;
    if (!neph_texture_filters(vulkan, params->format)) {
        neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                  "grid_format=%s: the device '%s' does not interpolate 3D images of it",
                  neph_texel_formats[params->format], vulkan->description.device);
        neph_hint(diag, "set another grid_format, or grid_sampling=exact, which needs no texture");
        return NEPH_ERR_UNSUPPORTED;
    }
    for (int axis = 0; axis < 3; axis++)
        if (params->size[axis] > most)
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "the texture '%s' has %d texels along a side; the device allows %d: "
                             "set grid_sampling=exact",
                             params->name, params->size[axis], most);
    return NEPH_OK;
}

/* --- creation ----------------------------------------------------------------------------- */

static VkResult create_image(const struct neph_vulkan *vulkan,
                             const struct neph_texture_params *params, struct neph_texture *texture)
{
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_3D,
        .format = formats[params->format].format,
        .extent = {(uint32_t)params->size[0], (uint32_t)params->size[1], (uint32_t)params->size[2]},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    VkMemoryRequirements requirements;
    VkResult result = vulkan->api.vkCreateImage(vulkan->device, &info, NULL, &texture->image);
    if (result != VK_SUCCESS)
        return result;
    vulkan->api.vkGetImageMemoryRequirements(vulkan->device, texture->image, &requirements);
    const VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = requirements.size,
        .memoryTypeIndex = neph_memory_type(vulkan, requirements.memoryTypeBits, 0,
                                            VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT),
    };
    if (memory.memoryTypeIndex == UINT32_MAX)
        return VK_ERROR_FEATURE_NOT_PRESENT;
    result = vulkan->api.vkAllocateMemory(vulkan->device, &memory, NULL, &texture->memory);
    if (result == VK_SUCCESS)
        neph_device_memory_take(texture->memory_bytes = requirements.size);
    return result == VK_SUCCESS
               ? vulkan->api.vkBindImageMemory(vulkan->device, texture->image, texture->memory, 0)
               : result;
}

static const VkImageSubresourceRange whole = {
    .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = 1};

static VkResult create_view(const struct neph_vulkan *vulkan, enum neph_texel_format format,
                            struct neph_texture *texture)
{
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = texture->image,
        .viewType = VK_IMAGE_VIEW_TYPE_3D,
        .format = formats[format].format,
        .subresourceRange = whole,
    };
    const VkSamplerCreateInfo sampler = {
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = VK_FILTER_LINEAR,
        .minFilter = VK_FILTER_LINEAR,
        .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
        .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
        .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
    };
    const VkResult result = vulkan->api.vkCreateImageView(vulkan->device, &view, NULL,
                                                          &texture->view);
    return result == VK_SUCCESS
               ? vulkan->api.vkCreateSampler(vulkan->device, &sampler, NULL, &texture->sampler)
               : result;
}

/* --- filling ------------------------------------------------------------------------------ */

static void convert(const float *values, size_t count, enum neph_texel_format format, void *texels)
{
    if (format == NEPH_TEXEL_R32F)
        memcpy(texels, values, count * sizeof(*values));
    for (size_t i = 0; i < count && format == NEPH_TEXEL_R16F; i++)
        ((uint16_t *)texels)[i] = neph_rt_to_half(values[i]);
    for (size_t i = 0; i < count && format == NEPH_TEXEL_R8; i++)
        ((uint8_t *)texels)[i] = (uint8_t)lrintf(255.0f * values[i]);
}

static void change_layout(const struct neph_vulkan *vulkan, const struct neph_lane *lane,
                          const struct neph_texture *texture, bool is_full)
{
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = is_full ? VK_ACCESS_TRANSFER_WRITE_BIT : 0,
        .dstAccessMask = is_full ? VK_ACCESS_SHADER_READ_BIT : VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = is_full ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = is_full ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                             : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = texture->image,
        .subresourceRange = whole,
    };
    vulkan->api.vkCmdPipelineBarrier(
        lane->commands,
        is_full ? VK_PIPELINE_STAGE_TRANSFER_BIT : VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
        is_full ? VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT : VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL,
        0, NULL, 1, &barrier);
}

/* A group of slabs that is copied together. */
struct slabs {
    const struct neph_texture_params *params;
    size_t count_each; /* values of a slab */
    int first, count;
    float *values;               /* beginning with slab `first`; owned */
    struct neph_buffer *staging; /* the values converted to texels */
};

static void fill_slab(int i, void *context)
{
    const struct slabs *slabs = context;
    const size_t count = slabs->count_each;
    const enum neph_texel_format format = slabs->params->format;
    float *values = slabs->values + (size_t)i * count;
    slabs->params->slab(slabs->params->context, slabs->first + i, values);
    convert(values, count, format,
            (char *)slabs->staging->mapped + (size_t)i * count * formats[format].bytes);
}

static VkResult copy_slabs(const struct neph_vulkan *vulkan, const struct slabs *slabs,
                           const struct neph_texture *texture)
{
    const int *size = slabs->params->size;
    const VkBufferImageCopy region = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageOffset = {0, 0, slabs->first},
        .imageExtent = {(uint32_t)size[0], (uint32_t)size[1], (uint32_t)slabs->count},
    };
    struct neph_lane *lane;
    VkResult result = neph_lane_begin(vulkan, &lane);
    if (result != VK_SUCCESS)
        return result;
    if (slabs->first == 0)
        change_layout(vulkan, lane, texture, false);
    vulkan->api.vkCmdCopyBufferToImage(lane->commands, slabs->staging->handle, texture->image,
                                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    if (slabs->first + slabs->count == size[2])
        change_layout(vulkan, lane, texture, true);
    result = neph_lane_send(vulkan, lane);
    return result == VK_SUCCESS ? neph_lanes_wait(vulkan, vulkan->lanes->sent) : result;
}

/* Copy a few megabytes of slabs at a time: this avoids a second copy of the whole grid in memory,
 * and a wait for the device after each slab. */
static enum neph_status fill(const struct neph_vulkan *vulkan,
                             const struct neph_texture_params *params,
                             const struct neph_texture *texture, struct neph_diag *diag)
{
    const size_t group_bytes = (size_t)4 << 20;
    struct neph_buffer staging = {0};
    struct slabs slabs = {params,  (size_t)params->size[0] * (size_t)params->size[1], 0, 0, NULL,
                          &staging};
    const size_t fitting = group_bytes / (slabs.count_each * sizeof(*slabs.values));
    const int depth = params->size[2];
    const int group = fitting < 1 ? 1 : fitting < (size_t)depth ? (int)fitting : depth;
    const size_t group_count = (size_t)group * slabs.count_each;
    slabs.values = malloc(group_count * sizeof(*slabs.values));
    enum neph_status status = slabs.values ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD,
                                    group_count * formats[params->format].bytes, "staging",
                                    &staging, diag);
    for (; slabs.first < depth && !status; slabs.first += group) {
        slabs.count = depth - slabs.first < group ? depth - slabs.first : group;
        status = neph_parallel_rows(slabs.count, fill_slab, &slabs, diag);
        const VkResult result = status ? VK_SUCCESS : copy_slabs(vulkan, &slabs, texture);
        if (result != VK_SUCCESS)
            status = neph_vulkan_fail(result, params->name, diag);
    }
    neph_buffer_destroy(vulkan, &staging);
    free(slabs.values);
    return status;
}

enum neph_status neph_texture_create(const struct neph_vulkan *vulkan,
                                     const struct neph_texture_params *params,
                                     struct neph_texture *texture, struct neph_diag *diag)
{
    struct neph_texture made = {.image = VK_NULL_HANDLE};
    enum neph_status status = check(vulkan, params, diag);
    if (status)
        return status;
    VkResult result = create_image(vulkan, params, &made);
    if (result == VK_SUCCESS)
        result = create_view(vulkan, params->format, &made);
    status = result == VK_SUCCESS ? fill(vulkan, params, &made, diag)
                                  : neph_vulkan_fail(result, params->name, diag);
    if (status) {
        neph_texture_destroy(vulkan, &made);
        return status;
    }
    neph_vulkan_name(vulkan, VK_OBJECT_TYPE_IMAGE, (uint64_t)made.image, params->name);
    *texture = made;
    return NEPH_OK;
}

void neph_texture_destroy(const struct neph_vulkan *vulkan, struct neph_texture *texture)
{
    if (texture->view)
        neph_kernel_sets_forget_image(vulkan, texture->view);
    vulkan->api.vkDestroySampler(vulkan->device, texture->sampler, NULL);
    vulkan->api.vkDestroyImageView(vulkan->device, texture->view, NULL);
    vulkan->api.vkDestroyImage(vulkan->device, texture->image, NULL);
    vulkan->api.vkFreeMemory(vulkan->device, texture->memory, NULL);
    neph_device_memory_give(texture->memory_bytes);
    *texture = (struct neph_texture){.image = VK_NULL_HANDLE};
}

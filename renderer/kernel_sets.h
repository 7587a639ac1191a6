/* SPDX-License-Identifier: MIT
 *
 * Descriptor sets of kernels: one for each combination of buffers and images that a kernel was run
 * with, kept until one of these is destroyed. Not for other folders.
 */
#ifndef NEPH_RENDERER_KERNEL_SETS_H
#define NEPH_RENDERER_KERNEL_SETS_H

#include "renderer/kernel.h"

/* The resources of a set; the counts are in the kernel's params. */
struct neph_kernel_bound {
    VkBuffer buffers[NEPH_KERNEL_BUFFERS_MAX]; /* the buffers of the array come last */
    VkBufferView texels[NEPH_GPU_TEXEL_FORMATS][NEPH_KERNEL_BUFFERS_MAX];
    VkImageView images[NEPH_KERNEL_IMAGES_MAX];
    VkSampler samplers[NEPH_KERNEL_IMAGES_MAX];
};

/* Created at the first call, owned by the device. */
VkResult neph_kernel_sets_get(const struct neph_kernel *kernel,
                              const struct neph_kernel_bound *bound, VkDescriptorSet *handle);

/* Before a buffer or an image is destroyed: wait for all batches in flight and destroy the sets
 * that contain it. */
void neph_kernel_sets_remove_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer);
void neph_kernel_sets_remove_image(const struct neph_vulkan *vulkan, VkImageView image);

/* For neph_vulkan_create() and _destroy(); the latter accepts NULL. NULL: no memory. */
struct neph_kernel_sets *neph_kernel_sets_create(void);
void neph_kernel_sets_destroy(struct neph_vulkan *vulkan);

#endif

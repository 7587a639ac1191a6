/* SPDX-License-Identifier: MIT
 *
 * What a kernel is bound to: a descriptor set for each choice of buffers and images that it was run
 * with, kept until one of them goes. Not for other folders.
 */
#ifndef NEPH_RENDERER_KERNEL_SETS_H
#define NEPH_RENDERER_KERNEL_SETS_H

#include "renderer/compute.h"

struct neph_kernel_sets;

/* NULL: no memory. Free with _destroy. */
struct neph_kernel_sets *neph_kernel_sets_create(void);

/* NULL is fine. */
void neph_kernel_sets_destroy(const struct neph_vulkan *vulkan, struct neph_kernel_sets *sets);

/* The set for the buffers and images of a dispatch. */
VkResult neph_kernel_sets_get(const struct neph_kernel *kernel,
                              const struct neph_dispatch *dispatch, VkDescriptorSet *handle);

/* Before a buffer goes, as neph_kernels_forget() of compute.h. */
void neph_kernels_forget_buffer(const struct neph_vulkan *vulkan, VkBuffer buffer);

#endif

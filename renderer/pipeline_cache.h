/* SPDX-License-Identifier: MIT
 *
 * What a driver has compiled, kept on disk for the next run: a VkPipelineCache in a file that is
 * named after the device and the driver. It only saves time: a file that is broken, or that cannot
 * be read or written, is none. Not for other folders.
 */
#ifndef NEPH_RENDERER_PIPELINE_CACHE_H
#define NEPH_RENDERER_PIPELINE_CACHE_H

#include "renderer/vulkan_device.h"

/* vulkan->pipelines, with what the file has; `folder` is made when the file is written. After
 * NEPH_ERR_MEMORY or _ENGINE there is none, and nothing to destroy. */
enum neph_status neph_pipeline_cache_create(struct neph_vulkan *vulkan, const char *folder,
                                            struct neph_diag *diag);

/* Writes the file, whole or not at all, when there is more in it than there was. Fine without
 * one. */
void neph_pipeline_cache_destroy(struct neph_vulkan *vulkan);

/* For vkCreateComputePipelines(); null: there is none. */
VkPipelineCache neph_pipeline_cache_handle(const struct neph_vulkan *vulkan);

#endif

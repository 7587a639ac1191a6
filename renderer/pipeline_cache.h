/* SPDX-License-Identifier: MIT
 *
 * Pipelines compiled by the driver, kept on disk for the next run: a VkPipelineCache in a file
 * named after the device and the driver. It only saves time: a file that is damaged, or cannot be
 * read or written, counts as empty. Not for other folders.
 */
#ifndef NEPH_RENDERER_PIPELINE_CACHE_H
#define NEPH_RENDERER_PIPELINE_CACHE_H

#include "renderer/vulkan_device.h"

/* Create vulkan->pipelines from the file; `folder` is created when the file is written. After
 * NEPH_ERR_MEMORY or NEPH_ERR_ENGINE there is nothing to destroy. */
enum neph_status neph_pipeline_cache_create(struct neph_vulkan *vulkan, const char *folder,
                                            struct neph_diag *diag);

/* Write the file, completely or not at all, if the cache has grown. Does nothing without a cache.
 */
void neph_pipeline_cache_destroy(struct neph_vulkan *vulkan);

/* For vkCreateComputePipelines(); null: no cache. */
VkPipelineCache neph_pipeline_cache_handle(const struct neph_vulkan *vulkan);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The Vulkan device that our own engines run on, as the environment names it.
 */
#ifndef NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H
#define NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H

#include "harness/engines/engine.h"
#include "renderer/vulkan.h"

/* NEPH_VULKAN_DEVICE: a part of the device's name. NEPH_VULKAN_VALIDATION=1: with the validation
 * layers. The name is the environment's own string. */
struct neph_vulkan_params neph_vulkan_device_params(void);

/* That device, with what it compiles kept in the cache (neph_cache_path()). Errors as of
 * neph_vulkan_create(). */
enum neph_status neph_vulkan_open(struct neph_vulkan **vulkan, struct neph_diag *diag);

/* neph_engine.probe of an engine that needs nothing but the device. */
void neph_vulkan_probe(struct neph_engine_info *info);

#endif

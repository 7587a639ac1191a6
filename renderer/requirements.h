/* SPDX-License-Identifier: MIT
 *
 * What the renderers use of a Vulkan device beyond what Vulkan 1.2 promises, as one table, and the
 * choice of a device by it. Nothing here calls Vulkan: tests describe devices that there are not.
 * docs/devices.md has the table in words. Not for other folders.
 */
#ifndef NEPH_RENDERER_REQUIREMENTS_H
#define NEPH_RENDERER_REQUIREMENTS_H

#include "base/status.h"
#include "renderer/vulkan_description.h"

#include <volk.h>

/* What a driver says of a device, as far as the table has a row for it. */
struct neph_device_facts {
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    VkBool32 is_cpu;
    uint32_t api_version;
    VkBool32 has_compute_queue;
    uint32_t timestamp_bits; /* of that queue */
    VkPhysicalDeviceLimits limits;
    VkPhysicalDeviceFeatures features;
    VkPhysicalDeviceVulkan12Features features_12;
    VkPhysicalDeviceSubgroupProperties subgroup;
    VkFormatFeatureFlags r32f_features; /* of images with optimal tiling */
};

enum neph_requirement_kind {
    NEPH_REQUIREMENT_FEATURE, /* one that is enabled where the device has it; 1 is needed */
    NEPH_REQUIREMENT_LEAST,
    NEPH_REQUIREMENT_BITS, /* all of these */
    NEPH_REQUIREMENT_VERSION,
    NEPH_REQUIREMENT_KIND_COUNT,
};

enum neph_requirement_necessity {
    NEPH_REQUIRED,
    NEPH_REQUIRED_OF_CPU, /* and nothing that a GPU is asked for */
    NEPH_OPTIONAL,
    NEPH_REQUIREMENT_NECESSITY_COUNT,
};

struct neph_requirement {
    const char *name; /* as Vulkan calls it */
    enum neph_requirement_kind kind;
    enum neph_requirement_necessity necessity;
    size_t offset; /* of its number of 32 bits in struct neph_device_facts */
    uint32_t needed;
    const char *purpose; /* after "for" */
    const char *without; /* what is done where an optional one is missing; else NULL */
};

const struct neph_requirement *neph_requirements(int *count);

/* Whether a device is asked for it at all, and has it. */
bool neph_requirement_applies(const struct neph_requirement *row,
                              const struct neph_device_facts *facts);
bool neph_requirement_is_met(const struct neph_requirement *row,
                             const struct neph_device_facts *facts);

/* What a device has of a row, in words and numbers for a person. */
struct neph_vulkan_requirement neph_requirement_answer(const struct neph_requirement *row,
                                                       const struct neph_device_facts *facts);

/* NEPH_ERR_UNAVAILABLE where it lacks what is required: which feature or limit, of which device,
 * what it has, what is needed, for what; the names of all others that it lacks; and the way out. */
enum neph_status neph_requirements_check(const struct neph_device_facts *facts,
                                         struct neph_diag *diag);

/* The features of the table that the device has, to be enabled. */
void neph_requirements_features(const struct neph_device_facts *facts,
                                VkPhysicalDeviceFeatures *features,
                                VkPhysicalDeviceVulkan12Features *features_12);

/* Which of `count` devices is used: of those that are named like `wanted` (NULL: all) and have what
 * is required the first, but a CPU before all others, since every machine can have it and results
 * can be compared between machines. NEPH_ERR_UNAVAILABLE: none, with why not. */
enum neph_status neph_requirements_choose(const struct neph_device_facts *facts, int count,
                                          const char *wanted, int *chosen, struct neph_diag *diag);

#endif

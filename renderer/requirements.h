/* SPDX-License-Identifier: MIT
 *
 * The table of features and limits that the renderers need beyond those that Vulkan 1.2 guarantees,
 * and the choice of a device by this table. Makes no Vulkan calls, so that tests can describe any
 * device. docs/devices.md has the table in words. Not for other folders.
 */
#ifndef NEPH_RENDERER_REQUIREMENTS_H
#define NEPH_RENDERER_REQUIREMENTS_H

#include "base/status.h"
#include "renderer/vulkan_description.h"

#include <volk.h>

/* Properties of a device that the table refers to. */
struct neph_device_facts {
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    VkBool32 is_cpu;
    uint32_t api_version;
    VkBool32 has_compute_queue;
    uint32_t timestamp_bits; /* of the compute queue */
    VkPhysicalDeviceLimits limits;
    VkPhysicalDeviceFeatures features;
    VkPhysicalDeviceVulkan12Features features_12;
    VkPhysicalDeviceSubgroupProperties subgroup;
    VkFormatFeatureFlags r32f_features; /* format features of R32F images with optimal tiling */
};

enum neph_requirement_kind {
    NEPH_REQUIREMENT_FEATURE, /* enabled where the device has it; `needed` is 1 */
    NEPH_REQUIREMENT_LEAST,
    NEPH_REQUIREMENT_BITS, /* all bits of `needed` */
    NEPH_REQUIREMENT_VERSION,
    NEPH_REQUIREMENT_KIND_COUNT,
};

enum neph_requirement_necessity {
    NEPH_REQUIRED,
    NEPH_REQUIRED_OF_CPU, /* ignored on GPUs */
    NEPH_OPTIONAL,
    NEPH_REQUIREMENT_NECESSITY_COUNT,
};

struct neph_requirement {
    const char *name; /* Vulkan's name */
    enum neph_requirement_kind kind;
    enum neph_requirement_necessity necessity;
    size_t offset; /* of a 32-bit number in struct neph_device_facts */
    uint32_t needed;
    const char *purpose; /* continues "for ..." */
    const char *without; /* the fallback when an optional row is not met; else NULL */
};

const struct neph_requirement *neph_requirements(int *count);

/* Whether the row applies to this kind of device, and whether the device meets it. */
bool neph_requirement_applies(const struct neph_requirement *row,
                              const struct neph_device_facts *facts);
bool neph_requirement_is_met(const struct neph_requirement *row,
                             const struct neph_device_facts *facts);

/* The device's value for a row, as text for the user. */
struct neph_vulkan_requirement neph_requirement_describe(const struct neph_requirement *row,
                                                         const struct neph_device_facts *facts);

/* NEPH_ERR_UNAVAILABLE when a required row is not met. The message has the feature or limit, the
 * device, its value, the needed value and the purpose; the names of all other unmet rows; and the
 * way out. */
enum neph_status neph_requirements_check(const struct neph_device_facts *facts,
                                         struct neph_diag *diag);

/* Set the features of the table that the device has, for enabling them. */
void neph_requirements_features(const struct neph_device_facts *facts,
                                VkPhysicalDeviceFeatures *features,
                                VkPhysicalDeviceVulkan12Features *features_12);

/* Choose one of `count` devices: the first that matches the name `wanted` (NULL: any) and meets all
 * required rows. CPU devices are preferred, since every machine can have one and results are then
 * comparable between machines. NEPH_ERR_UNAVAILABLE: no device, with the reasons. */
enum neph_status neph_requirements_choose(const struct neph_device_facts *facts, int count,
                                          const char *wanted, int *chosen, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Descriptions of a Vulkan device for reports, without a dependency on Vulkan's headers.
 */
#ifndef NEPH_RENDERER_VULKAN_DESCRIPTION_H
#define NEPH_RENDERER_VULKAN_DESCRIPTION_H

#include <stdbool.h>
#include <stdint.h>

/* The device and driver of a measurement; part of job keys and reports. */
struct neph_vulkan_description {
    char device[256];
    char driver[640];     /* name, version and build of the driver */
    char api_version[32]; /* of the device, such as "1.3.230" */
    uint32_t subgroup_size;
    bool is_cpu;
};

/* One row of the table of requirements (requirements.h) with the device's value. */
struct neph_vulkan_requirement {
    const char *name;    /* Vulkan's name */
    const char *purpose; /* continues "for ..." */
    const char *without; /* the fallback when an optional row is not met; else NULL */
    char needed[32], value[32];
    bool is_required, is_met;
};

enum { NEPH_VULKAN_REQUIREMENTS_MAX = 24 };

#endif

/* SPDX-License-Identifier: MIT */
#include "harness/engines/vulkan_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct neph_vulkan_params neph_vulkan_device_params(void)
{
    const char *validation = getenv("NEPH_VULKAN_VALIDATION");
    const char *device = getenv("NEPH_VULKAN_DEVICE");
    return (struct neph_vulkan_params){
        .validation = validation && strcmp(validation, "1") == 0,
        .device = device && device[0] ? device : NULL,
    };
}

void neph_vulkan_probe(struct neph_engine_info *info)
{
    *info = (struct neph_engine_info){.available = false};
    struct neph_diag diag = {.line = 0};
    struct neph_vulkan *vulkan = NULL;
    const struct neph_vulkan_params params = neph_vulkan_device_params();
    if (neph_vulkan_create(&params, &vulkan, &diag)) {
        snprintf(info->missing, sizeof(info->missing), "%s", diag.message);
        snprintf(info->install_line, sizeof(info->install_line), "%.255s", diag.hint);
        return;
    }
    const struct neph_vulkan_description description = neph_vulkan_describe(vulkan);
    info->available = true;
    snprintf(info->version, sizeof(info->version), "Vulkan %s, %.90s", description.api_version,
             description.driver);
    snprintf(info->device, sizeof(info->device), "%.100s, subgroup %u", description.device,
             (unsigned)description.subgroup_size);
    neph_vulkan_destroy(vulkan);
}

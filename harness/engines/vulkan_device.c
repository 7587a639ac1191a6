/* SPDX-License-Identifier: MIT */
#include "harness/engines/vulkan_device.h"

#include "base/threads.h"
#include "harness/data.h"

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

enum neph_status neph_vulkan_open(struct neph_vulkan **vulkan, struct neph_diag *diag)
{
    struct neph_vulkan_params params = neph_vulkan_device_params();
    char *cache = neph_cache_path();
    if (!cache)
        return neph_fail_memory(diag);
    params.cache_folder = cache;
    const enum neph_status status = neph_vulkan_create(&params, vulkan, diag);
    free(cache);
    return status;
}

/* Outlives the call when the driver hangs. */
struct search {
    struct neph_vulkan_params params;
    struct neph_engine_info info;
};

static void search_device(void *context)
{
    struct search *search = context;
    struct neph_engine_info *info = &search->info;
    struct neph_diag diag = {.line = 0};
    struct neph_vulkan *vulkan = NULL;
    const enum neph_status status = neph_vulkan_create(&search->params, &vulkan, &diag);
    if (status) {
        info->broken = status != NEPH_ERR_UNAVAILABLE;
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

void neph_vulkan_probe(struct neph_engine_info *info)
{
    static const double limit_s = 30.0; /* lavapipe needs 0.1 s */
    struct search *search = calloc(1, sizeof(*search));
    *info = (struct neph_engine_info){.broken = true};
    if (!search) {
        snprintf(info->missing, sizeof(info->missing), "out of memory");
        return;
    }
    search->params = neph_vulkan_device_params();
    if (!neph_finishes_within(limit_s, search_device, search)) {
        snprintf(info->missing, sizeof(info->missing),
                 "the Vulkan driver has not answered within %g s", limit_s);
        return;
    }
    *info = search->info;
    free(search);
}

/* SPDX-License-Identifier: MIT */
#include "harness/engines/vulkan_device.h"

#include "base/threads.h"
#include "harness/data.h"
#include "renderer/usable.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum neph_vulkan_validation validation_named(const char *word)
{
    if (word && strcmp(word, "1") == 0)
        return NEPH_VALIDATION_ON;
    return word && strcmp(word, "shaders") == 0 ? NEPH_VALIDATION_SHADERS : NEPH_VALIDATION_OFF;
}

struct neph_vulkan_params neph_vulkan_device_params(void)
{
    const char *device = getenv("NEPH_VULKAN_DEVICE");
    return (struct neph_vulkan_params){
        .validation = validation_named(getenv("NEPH_VULKAN_VALIDATION")),
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

/* ---- sharing --------------------------------------------------------------------------------- */

static enum neph_status open_device(struct neph_open_device **device, struct neph_diag *diag)
{
    struct neph_open_device *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_vulkan_open(&opened->vulkan, diag);
    if (status) {
        free(opened);
        return status;
    }
    opened->user_count = 1;
    *device = opened;
    return NEPH_OK;
}

/* Close a device that cannot serve another user. */
static void drop_unusable(struct neph_shared_device *shared)
{
    if (shared->open && !neph_vulkan_is_usable(shared->open->vulkan))
        neph_shared_device_close(shared);
}

enum neph_status neph_device_acquire(struct neph_shared_device *shared,
                                     struct neph_open_device **device, struct neph_diag *diag)
{
    if (!shared)
        return open_device(device, diag);
    drop_unusable(shared);
    const enum neph_status status = shared->open ? NEPH_OK : open_device(&shared->open, diag);
    if (status)
        return status;
    shared->open->user_count++;
    *device = shared->open;
    return NEPH_OK;
}

void neph_device_release(struct neph_open_device *device)
{
    if (!device || --device->user_count > 0)
        return;
    neph_vulkan_destroy(device->vulkan);
    free(device);
}

void neph_shared_device_close(struct neph_shared_device *shared)
{
    if (!shared)
        return;
    neph_device_release(shared->open);
    shared->open = NULL;
}

/* ---- probing --------------------------------------------------------------------------------- */

/* The state of a search for a device; it outlives the call if the driver hangs. */
struct search {
    struct neph_open_device *device;
    enum neph_status status;
    struct neph_diag diag;
};

static void search_device(void *context)
{
    struct search *search = context;
    search->status = open_device(&search->device, &search->diag);
}

/* Open a device in bounded time; false: `info` has the reason. */
static bool find_device(struct neph_open_device **device, struct neph_engine_info *info)
{
    static const double limit_s = 30.0; /* lavapipe needs 0.1 s */
    struct search *search = calloc(1, sizeof(*search));
    info->broken = true;
    if (!search) {
        snprintf(info->missing, sizeof(info->missing), "out of memory");
        return false;
    }
    if (!neph_call_with_timeout(limit_s, search_device, search)) {
        snprintf(info->missing, sizeof(info->missing),
                 "the Vulkan driver has not answered within %g s", limit_s);
        return false;
    }
    const bool is_found = search->status == NEPH_OK;
    info->broken = !is_found && search->status != NEPH_ERR_UNAVAILABLE;
    *device = search->device;
    snprintf(info->missing, sizeof(info->missing), "%s", search->diag.message);
    snprintf(info->install_line, sizeof(info->install_line), "%.255s", search->diag.hint);
    free(search);
    return is_found;
}

void neph_vulkan_probe(const struct neph_engine *engine, struct neph_shared_device *shared,
                       struct neph_engine_info *info)
{
    (void)engine;
    struct neph_shared_device own = {.open = NULL};
    struct neph_shared_device *probed = shared ? shared : &own;
    *info = (struct neph_engine_info){.available = false};
    drop_unusable(probed);
    if (probed->open || find_device(&probed->open, info)) {
        const struct neph_vulkan_description description = neph_vulkan_describe(
            probed->open->vulkan);
        info->available = true;
        snprintf(info->version, sizeof(info->version), "Vulkan %s, %.90s", description.api_version,
                 description.driver);
        snprintf(info->device, sizeof(info->device), "%.100s, subgroup %u", description.device,
                 (unsigned)description.subgroup_size);
    }
    neph_shared_device_close(&own);
}

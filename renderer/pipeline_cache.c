/* SPDX-License-Identifier: MIT */
#include "renderer/pipeline_cache.h"

#include "base/files.h"
#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A larger file is discarded: it contains code of old versions of shaders, which is never used
 * again. */
enum { FILE_MAX_BYTES = 64 << 20, HASH_BYTES = NEPH_HASH_HEX_SIZE - 1 };

struct neph_pipeline_cache {
    VkPipelineCache handle;
    char *folder, *path;
    char hash[NEPH_HASH_HEX_SIZE]; /* of the file's contents; empty: nothing usable */
};

/* --- the file: a hash, then the driver's bytes -------------------------------------------- */

/* The name has all properties that decide whether code fits the driver. */
static enum neph_status name_file(const struct neph_vulkan *vulkan, char name[80],
                                  struct neph_diag *diag)
{
    VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &id};
    vkGetPhysicalDeviceProperties2(vulkan->physical_device, &properties);
    struct {
        uint32_t vendor, device, driver;
        uint8_t device_uuid[VK_UUID_SIZE], driver_uuid[VK_UUID_SIZE], cache_uuid[VK_UUID_SIZE];
    } key = {properties.properties.vendorID,
             properties.properties.deviceID,
             properties.properties.driverVersion,
             {0},
             {0},
             {0}};
    memcpy(key.device_uuid, id.deviceUUID, VK_UUID_SIZE);
    memcpy(key.driver_uuid, id.driverUUID, VK_UUID_SIZE);
    memcpy(key.cache_uuid, properties.properties.pipelineCacheUUID, VK_UUID_SIZE);
    char hash[NEPH_HASH_HEX_SIZE];
    const enum neph_status status = neph_hash(&key, sizeof(key), hash, diag);
    if (!status)
        snprintf(name, 80, "pipelines_%.32s.bin", hash);
    return status;
}

/* Size of the driver's bytes in `file`; 0 if they do not match the hash. */
static size_t check_file(struct neph_pipeline_cache *cache, const char *file, size_t size_bytes)
{
    char hash[NEPH_HASH_HEX_SIZE];
    if (size_bytes <= HASH_BYTES ||
        neph_hash(file + HASH_BYTES, size_bytes - HASH_BYTES, hash, NULL) ||
        memcmp(file, hash, HASH_BYTES) != 0)
        return 0;
    memcpy(cache->hash, hash, sizeof(hash));
    return size_bytes - HASH_BYTES;
}

static void write_file(const struct neph_pipeline_cache *cache, const char *file, size_t size_bytes)
{
    if (!neph_dir_create(cache->folder, NULL))
        neph_file_write(cache->path, file, size_bytes, NULL);
}

/* --- the cache ---------------------------------------------------------------------------- */

static void free_cache(struct neph_pipeline_cache *cache)
{
    free(cache->path);
    free(cache->folder);
    free(cache);
}

/* The driver checks the header of its bytes and ignores unsuitable ones. */
static VkResult create_handle(const struct neph_vulkan *vulkan, struct neph_pipeline_cache *cache)
{
    char *file = NULL;
    size_t size_bytes = 0;
    if (neph_file_read(cache->path, FILE_MAX_BYTES, &file, &size_bytes, NULL))
        file = NULL;
    const size_t data_bytes = file ? check_file(cache, file, size_bytes) : 0;
    const VkPipelineCacheCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
        .initialDataSize = data_bytes,
        .pInitialData = data_bytes > 0 ? file + HASH_BYTES : NULL,
    };
    const VkResult result = vulkan->api.vkCreatePipelineCache(vulkan->device, &info, NULL,
                                                              &cache->handle);
    free(file);
    return result;
}

enum neph_status neph_pipeline_cache_create(struct neph_vulkan *vulkan, const char *folder,
                                            struct neph_diag *diag)
{
    char name[80];
    struct neph_pipeline_cache *cache = calloc(1, sizeof(*cache));
    enum neph_status status = cache ? name_file(vulkan, name, diag) : neph_fail_memory(diag);
    if (!status) {
        cache->folder = strdup(folder);
        cache->path = neph_path_join(folder, name);
        status = cache->folder && cache->path ? NEPH_OK : neph_fail_memory(diag);
    }
    if (!status) {
        const VkResult result = create_handle(vulkan, cache);
        if (result != VK_SUCCESS)
            status = neph_vulkan_fail(result, "create the pipeline cache", diag);
    }
    if (status && cache)
        free_cache(cache);
    else if (!status)
        vulkan->pipelines = cache;
    return status;
}

/* Write the hash, then the driver's bytes. */
static void save_cache(const struct neph_vulkan *vulkan, const struct neph_pipeline_cache *cache)
{
    size_t data_bytes = 0;
    char hash[NEPH_HASH_HEX_SIZE];
    vulkan->api.vkGetPipelineCacheData(vulkan->device, cache->handle, &data_bytes, NULL);
    if (data_bytes > FILE_MAX_BYTES - HASH_BYTES) {
        unlink(cache->path);
        return;
    }
    char *file = malloc(HASH_BYTES + data_bytes);
    if (!file ||
        vulkan->api.vkGetPipelineCacheData(vulkan->device, cache->handle, &data_bytes,
                                           file + HASH_BYTES) != VK_SUCCESS ||
        neph_hash(file + HASH_BYTES, data_bytes, hash, NULL) || strcmp(hash, cache->hash) == 0) {
        free(file);
        return;
    }
    memcpy(file, hash, HASH_BYTES);
    write_file(cache, file, HASH_BYTES + data_bytes);
    free(file);
}

void neph_pipeline_cache_destroy(struct neph_vulkan *vulkan)
{
    struct neph_pipeline_cache *cache = vulkan->pipelines;
    if (!cache)
        return;
    save_cache(vulkan, cache);
    vulkan->api.vkDestroyPipelineCache(vulkan->device, cache->handle, NULL);
    free_cache(cache);
    vulkan->pipelines = NULL;
}

VkPipelineCache neph_pipeline_cache_handle(const struct neph_vulkan *vulkan)
{
    return vulkan->pipelines ? vulkan->pipelines->handle : VK_NULL_HANDLE;
}

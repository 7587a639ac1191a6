/* SPDX-License-Identifier: MIT */
#include "renderer/vulkan_device.h"

static const struct {
    VkResult result;
    enum neph_status status;
    const char *name;
} results[] = {
    {VK_ERROR_OUT_OF_HOST_MEMORY, NEPH_ERR_MEMORY, "out of host memory"},
    {VK_ERROR_OUT_OF_DEVICE_MEMORY, NEPH_ERR_MEMORY, "out of device memory"},
    {VK_ERROR_OUT_OF_POOL_MEMORY, NEPH_ERR_MEMORY, "out of pool memory"},
    {VK_ERROR_TOO_MANY_OBJECTS, NEPH_ERR_MEMORY, "too many objects"},
    {VK_ERROR_INITIALIZATION_FAILED, NEPH_ERR_UNAVAILABLE, "initialization failed"},
    {VK_ERROR_INCOMPATIBLE_DRIVER, NEPH_ERR_UNAVAILABLE, "no compatible driver"},
    {VK_ERROR_LAYER_NOT_PRESENT, NEPH_ERR_UNAVAILABLE, "layer not present"},
    {VK_ERROR_EXTENSION_NOT_PRESENT, NEPH_ERR_UNAVAILABLE, "extension not present"},
    {VK_ERROR_FEATURE_NOT_PRESENT, NEPH_ERR_UNAVAILABLE, "feature not present"},
    {VK_ERROR_MEMORY_MAP_FAILED, NEPH_ERR_ENGINE, "memory map failed"},
    {VK_ERROR_DEVICE_LOST, NEPH_ERR_ENGINE, "device lost"},
};

enum neph_status neph_vulkan_fail(VkResult result, const char *what, struct neph_diag *diag)
{
    for (size_t i = 0; i < sizeof(results) / sizeof(results[0]); i++)
        if (results[i].result == result)
            return neph_fail(diag, results[i].status, "Vulkan: %s: %s", what, results[i].name);
    return neph_fail(diag, NEPH_ERR_ENGINE, "Vulkan: %s: VkResult %d", what, (int)result);
}

void neph_vulkan_name(const struct neph_vulkan *vulkan, VkObjectType type, uint64_t object,
                      const char *name)
{
    if (!vulkan->set_object_name)
        return;
    const VkDebugUtilsObjectNameInfoEXT info = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
        .objectType = type,
        .objectHandle = object,
        .pObjectName = name,
    };
    vulkan->set_object_name(vulkan->device, &info);
}

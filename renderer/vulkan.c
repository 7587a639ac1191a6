/* SPDX-License-Identifier: MIT */
#include "renderer/vulkan.h"

#include "base/threads.h"
#include "base/workers.h"
#include "renderer/kernel_sets.h"
#include "renderer/lane.h"
#include "renderer/pipeline_cache.h"
#include "renderer/requirements.h"
#include "renderer/shader_cache.h"

#include <dlfcn.h>
#include <link.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";
static const char install_driver[] = "apt-get install mesa-vulkan-drivers";
static const char install_validation[] = "apt-get install vulkan-validationlayers";

static const uint32_t api_version = VK_API_VERSION_1_2;

/* --- messages ----------------------------------------------------------------------------- */

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user)
{
    (void)severity;
    (void)types;
    struct neph_vulkan *vulkan = user;
    if (atomic_fetch_add(&vulkan->message_count, 1) == 0)
        snprintf(vulkan->first_message, sizeof(vulkan->first_message), "%s", data->pMessage);
    return VK_FALSE;
}

/* Filter of messages. Messages of the loader about other drivers (type GENERAL) are ignored. With
 * checks in shaders the layer warns about features that it enables itself, so only errors count. */
static VkDebugUtilsMessengerCreateInfoEXT messenger_info(struct neph_vulkan *vulkan,
                                                         enum neph_vulkan_validation validation)
{
    const VkDebugUtilsMessageSeverityFlagsEXT warning =
        validation == NEPH_VALIDATION_ON ? VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT : 0;
    return (VkDebugUtilsMessengerCreateInfoEXT){
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = warning | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = vulkan,
    };
}

/* --- instance ----------------------------------------------------------------------------- */

static enum neph_status unavailable_driver(VkResult result, const char *what,
                                           struct neph_diag *diag)
{
    neph_vulkan_fail(result, what, diag);
    neph_hint(diag, "%s", install_driver);
    return NEPH_ERR_UNAVAILABLE;
}

static bool has_validation_layer(void)
{
    VkLayerProperties layers[64];
    uint32_t count = sizeof(layers) / sizeof(layers[0]);
    const VkResult result = vkEnumerateInstanceLayerProperties(&count, layers);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(layers[i].layerName, validation_layer) == 0)
            return true;
    return false;
}

static enum neph_status create_messenger(struct neph_vulkan *vulkan,
                                         enum neph_vulkan_validation validation,
                                         struct neph_diag *diag)
{
    PFN_vkCreateDebugUtilsMessengerEXT create_messenger_ext =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(vulkan->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    vulkan->destroy_messenger = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
        vulkan->instance, "vkDestroyDebugUtilsMessengerEXT");
    vulkan->set_object_name = (PFN_vkSetDebugUtilsObjectNameEXT)vkGetInstanceProcAddr(
        vulkan->instance, "vkSetDebugUtilsObjectNameEXT");
    const VkDebugUtilsMessengerCreateInfoEXT info = messenger_info(vulkan, validation);
    const VkResult result = create_messenger_ext(vulkan->instance, &info, NULL, &vulkan->messenger);
    return result == VK_SUCCESS ? NEPH_OK : neph_vulkan_fail(result, "create the messenger", diag);
}

static enum neph_status create_instance(struct neph_vulkan *vulkan,
                                        enum neph_vulkan_validation validation,
                                        struct neph_diag *diag)
{
    VkResult result = volkInitialize();
    if (result != VK_SUCCESS)
        return unavailable_driver(result, "open the loader libvulkan.so.1", diag);
    if (vkEnumerateInstanceVersion == NULL)
        return unavailable_driver(VK_ERROR_INCOMPATIBLE_DRIVER, "Vulkan 1.1 or later", diag);
    if (validation != NEPH_VALIDATION_OFF && !has_validation_layer()) {
        neph_fail(diag, NEPH_ERR_UNAVAILABLE, "validation was requested but %s is not installed",
                  validation_layer);
        neph_hint(diag, "%s", install_validation);
        return NEPH_ERR_UNAVAILABLE;
    }

    /* The layer warns when core checks and checks in shaders are both enabled. */
    const VkValidationFeatureDisableEXT no_checks[] = {
        VK_VALIDATION_FEATURE_DISABLE_CORE_CHECKS_EXT};
    const VkValidationFeatureEnableEXT checks[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
        VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
        VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT};
    const VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(vulkan, validation);
    const VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger, /* also for creation and destruction of the instance */
        .enabledValidationFeatureCount = validation == NEPH_VALIDATION_SHADERS ? 3 : 1,
        .pEnabledValidationFeatures = checks,
        .disabledValidationFeatureCount = validation == NEPH_VALIDATION_SHADERS ? 1 : 0,
        .pDisabledValidationFeatures = no_checks,
    };
    const char *const layers[] = {validation_layer};
    const char *const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
    const VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "nephelometer",
        .apiVersion = api_version,
    };
    const VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validation != NEPH_VALIDATION_OFF ? &features : NULL,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation != NEPH_VALIDATION_OFF ? 1 : 0,
        .ppEnabledLayerNames = layers,
        .enabledExtensionCount = validation != NEPH_VALIDATION_OFF ? 1 : 0,
        .ppEnabledExtensionNames = extensions,
    };
    result = vkCreateInstance(&info, NULL, &vulkan->instance);
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY)
        return neph_fail_memory(diag);
    if (result != VK_SUCCESS)
        return unavailable_driver(result, "create an instance", diag);
    volkLoadInstanceOnly(vulkan->instance);
    return validation != NEPH_VALIDATION_OFF ? create_messenger(vulkan, validation, diag) : NEPH_OK;
}

/* --- physical device ---------------------------------------------------------------------- */

#define DEVICES_MAX 16

/* The first queue family with compute support; UINT32_MAX: none. */
static uint32_t find_queue_family(VkPhysicalDevice device, uint32_t *timestamp_bits)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = sizeof(families) / sizeof(families[0]);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families);
    for (uint32_t i = 0; i < count; i++)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            *timestamp_bits = families[i].timestampValidBits;
            return i;
        }
    return UINT32_MAX;
}

static struct neph_device_facts read_facts(VkPhysicalDevice device)
{
    VkPhysicalDeviceSubgroupProperties subgroup = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
    VkPhysicalDeviceVulkan12Features features_12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                          .pNext = &features_12};
    VkFormatProperties r32f;
    vkGetPhysicalDeviceProperties2(device, &properties);
    vkGetPhysicalDeviceFeatures2(device, &features);
    vkGetPhysicalDeviceFormatProperties(device, VK_FORMAT_R32_SFLOAT, &r32f);
    struct neph_device_facts facts = {
        .is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU,
        .api_version = properties.properties.apiVersion,
        .limits = properties.properties.limits,
        .features = features.features,
        .features_12 = features_12,
        .subgroup = subgroup,
        .r32f_features = r32f.optimalTilingFeatures,
    };
    facts.has_compute_queue = find_queue_family(device, &facts.timestamp_bits) != UINT32_MAX;
    snprintf(facts.device, sizeof(facts.device), "%s", properties.properties.deviceName);
    return facts;
}

static enum neph_status choose_device(struct neph_vulkan *vulkan, const char *wanted,
                                      struct neph_device_facts *facts, struct neph_diag *diag)
{
    VkPhysicalDevice devices[DEVICES_MAX];
    struct neph_device_facts all[DEVICES_MAX];
    uint32_t count = DEVICES_MAX;
    int chosen = 0;
    const VkResult result = vkEnumeratePhysicalDevices(vulkan->instance, &count, devices);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return unavailable_driver(result, "list the devices", diag);
    for (uint32_t i = 0; i < count; i++)
        all[i] = read_facts(devices[i]);
    const enum neph_status status = neph_requirements_choose(all, (int)count, wanted, &chosen,
                                                             diag);
    if (status)
        return status;
    vulkan->physical_device = devices[chosen];
    *facts = all[chosen];
    return NEPH_OK;
}

static void describe_device(struct neph_vulkan *vulkan)
{
    VkPhysicalDeviceSubgroupProperties subgroup = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, .pNext = &subgroup};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
    vkGetPhysicalDeviceProperties2(vulkan->physical_device, &properties);
    vkGetPhysicalDeviceMemoryProperties(vulkan->physical_device, &vulkan->memory);
    vulkan->limits = properties.properties.limits;

    struct neph_vulkan_description *description = &vulkan->description;
    const uint32_t version = properties.properties.apiVersion;
    snprintf(description->device, sizeof(description->device), "%s",
             properties.properties.deviceName);
    snprintf(description->driver, sizeof(description->driver), "%s %s", driver.driverName,
             driver.driverInfo);
    snprintf(description->api_version, sizeof(description->api_version), "%u.%u.%u",
             VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
             VK_API_VERSION_PATCH(version));
    description->subgroup_size = subgroup.subgroupSize;
    description->is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

/* --- device ------------------------------------------------------------------------------- */

static enum neph_status create_device(struct neph_vulkan *vulkan,
                                      const struct neph_device_facts *facts, struct neph_diag *diag)
{
    uint32_t timestamp_bits;
    vulkan->queue_family = find_queue_family(vulkan->physical_device, &timestamp_bits);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = vulkan->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    VkPhysicalDeviceFeatures features;
    VkPhysicalDeviceVulkan12Features features_12;
    neph_requirements_features(facts, &features, &features_12);
    const VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features_12,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .pEnabledFeatures = &features,
    };
    const VkResult result = vkCreateDevice(vulkan->physical_device, &info, NULL, &vulkan->device);
    if (result != VK_SUCCESS)
        return neph_vulkan_fail(result, "create the device", diag);
    volkLoadDeviceTable(&vulkan->api, vulkan->device);
    vulkan->api.vkGetDeviceQueue(vulkan->device, vulkan->queue_family, 0, &vulkan->queue);
    return NEPH_OK;
}

static enum neph_status create_lanes(struct neph_vulkan *vulkan, uint32_t timestamp_bits,
                                     struct neph_diag *diag)
{
    if (timestamp_bits > 0)
        vulkan->timestamp_mask = timestamp_bits >= 64 ? UINT64_MAX : (1ull << timestamp_bits) - 1;
    vulkan->timestamp_period_s = 1e-9 * (double)vulkan->limits.timestampPeriod;
    const VkResult result = neph_lanes_create(vulkan, timestamp_bits > 0);
    return result == VK_SUCCESS ? NEPH_OK
                                : neph_vulkan_fail(result, "create the command buffers", diag);
}

/* Callback of dl_iterate_phdr(): keep the library loaded for the lifetime of the process. */
static int hold_library(struct dl_phdr_info *info, size_t size, void *context)
{
    (void)size;
    (void)context;
    if (info->dlpi_name && strstr(info->dlpi_name, ".so"))
        dlopen(info->dlpi_name, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
    return 0;
}

/* Keep all drivers loaded. The loader unloads a driver with the last instance. NVIDIA's driver
 * allocates static thread-local storage at each load and never frees it: the 16th device of a
 * process would fail. */
static void hold_drivers(void)
{
    dl_iterate_phdr(hold_library, NULL);
}

/* The number of threads that compile kernels. A CPU driver compiles on one thread of its own, for
 * which all others wait: it gets a core. */
static int maker_count(const struct neph_vulkan *vulkan)
{
    const int processors = neph_processor_count();
    return vulkan->description.is_cpu && processors > 1 ? processors - 1 : processors;
}

enum neph_status neph_vulkan_create(const struct neph_vulkan_params *params,
                                    struct neph_vulkan **vulkan, struct neph_diag *diag)
{
    const struct neph_vulkan_params defaults = {0};
    if (!params)
        params = &defaults;
    struct neph_vulkan *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    pthread_mutex_init(&created->pipeline_lock, NULL);

    struct neph_device_facts facts;
    created->checks_shaders = params->validation == NEPH_VALIDATION_SHADERS;
    enum neph_status status = create_instance(created, params->validation, diag);
    if (!status)
        status = choose_device(created, params->device, &facts, diag);
    if (!status) {
        hold_drivers();
        describe_device(created);
        status = create_device(created, &facts, diag);
    }
    if (!status)
        status = create_lanes(created, facts.timestamp_bits, diag);
    if (!status)
        status = neph_workers_create(maker_count(created), &created->makers, diag);
    if (!status && !(created->sets = neph_kernel_sets_create()))
        status = neph_fail_memory(diag);
    if (!status && params->cache_folder)
        status = neph_shader_cache_create(params->cache_folder, &created->shaders, diag);
    if (!status && params->cache_folder)
        status = neph_pipeline_cache_create(created, params->cache_folder, diag);
    if (!status)
        status = neph_vulkan_check(created, diag);
    if (status) {
        neph_vulkan_destroy(created);
        return status;
    }
    *vulkan = created;
    return NEPH_OK;
}

int neph_vulkan_destroy(struct neph_vulkan *vulkan)
{
    if (!vulkan)
        return 0;
    if (vulkan->device) {
        neph_lanes_destroy(vulkan);
        neph_kernel_sets_destroy(vulkan);
        neph_kernels_destroy(vulkan);
        neph_pipeline_cache_destroy(vulkan);
        neph_shader_cache_destroy(vulkan->shaders);
        vulkan->api.vkDestroyDevice(vulkan->device, NULL);
    }
    if (vulkan->messenger)
        vulkan->destroy_messenger(vulkan->instance, vulkan->messenger, NULL);
    if (vulkan->instance)
        vkDestroyInstance(vulkan->instance, NULL);
    const int message_count = vulkan->message_count;
    pthread_mutex_destroy(&vulkan->pipeline_lock);
    free(vulkan);
    return message_count;
}

int neph_vulkan_requirements(const struct neph_vulkan *vulkan,
                             struct neph_vulkan_requirement answers[NEPH_VULKAN_REQUIREMENTS_MAX])
{
    const struct neph_device_facts facts = read_facts(vulkan->physical_device);
    int row_count, count = 0;
    const struct neph_requirement *rows = neph_requirements(&row_count);
    for (int i = 0; i < row_count; i++)
        if (neph_requirement_applies(&rows[i], &facts))
            answers[count++] = neph_requirement_answer(&rows[i], &facts);
    return count;
}

struct neph_vulkan_description neph_vulkan_describe(const struct neph_vulkan *vulkan)
{
    return vulkan->description;
}

enum neph_status neph_vulkan_check(const struct neph_vulkan *vulkan, struct neph_diag *diag)
{
    neph_workers_wait_for_all(vulkan->makers);
    if (vulkan->message_count == 0)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INTERNAL, "Vulkan validation, message 1 of %d: %s",
                     vulkan->message_count, vulkan->first_message);
}

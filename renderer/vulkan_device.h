/* SPDX-License-Identifier: MIT
 *
 * An open Vulkan device: created by vulkan.c, used by compute.c. Not for other folders.
 */
#ifndef NEPH_RENDERER_VULKAN_DEVICE_H
#define NEPH_RENDERER_VULKAN_DEVICE_H

#include "base/status.h"
#include "renderer/vulkan_description.h"

#include <pthread.h>
#include <stdatomic.h>
#include <volk.h>

struct neph_kernel;
struct neph_kernel_sets;    /* kernel_sets.h */
struct neph_lanes;          /* lane.h */
struct neph_pipeline_cache; /* pipeline_cache.h */
struct neph_shader_cache;   /* shader_cache.h */
struct neph_workers;        /* base/workers.h */

struct neph_vulkan {
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    struct VolkDeviceTable api; /* every call on the device uses this table */
    VkQueue queue;
    uint32_t queue_family;
    struct neph_lanes *lanes; /* owned; mutable also through a const device */
    double timestamp_period_s;
    uint64_t timestamp_mask; /* valid bits; 0: no clock */
    VkPhysicalDeviceMemoryProperties memory;
    VkPhysicalDeviceLimits limits;
    struct neph_pipeline_cache *pipelines; /* owned; NULL: nothing is kept on disk */
    struct neph_shader_cache *shaders;     /* owned; NULL: nothing is kept on disk */
    struct neph_kernel_sets *sets;         /* owned; grow also through a const device */
    struct neph_kernel *kernels;           /* owned; all kernels requested so far */
    struct neph_workers *makers;           /* owned; threads that compile kernels */
    atomic_bool is_ending;                 /* queued kernels need not be compiled */
    pthread_mutex_t pipeline_lock;         /* serialises pipeline creation by a CPU driver */
    struct neph_vulkan_description description;

    /* Validation. The functions are stored here because volk's globals belong to the instance that
     * was loaded last. */
    PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger;
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name; /* NULL without validation */
    VkDebugUtilsMessengerEXT messenger;
    bool checks_shaders;
    atomic_int message_count; /* kernels are compiled on several threads */
    char first_message[900];
};

/* The status for a VkResult that is not VK_SUCCESS, with "<what>: <name of the result>". */
enum neph_status neph_vulkan_fail(VkResult result, const char *what, struct neph_diag *diag);

/* Name an object for validation messages and debuggers. */
void neph_vulkan_name(const struct neph_vulkan *vulkan, VkObjectType type, uint64_t object,
                      const char *name);

#endif

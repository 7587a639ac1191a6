/* SPDX-License-Identifier: MIT
 *
 * A Vulkan 1.2 device for compute. The loader is opened at run time (volk) and not linked, so a
 * machine without Vulkan gets an error with an install command instead of a dynamic-linker error.
 *
 * Threads: a neph_vulkan is used by one thread at a time; create several one after the other. It
 * compiles its kernels on threads of its own.
 */
#ifndef NEPH_RENDERER_VULKAN_H
#define NEPH_RENDERER_VULKAN_H

#include "base/status.h"
#include "renderer/vulkan_description.h"

#include <stdbool.h>

struct neph_vulkan;

enum neph_vulkan_validation {
    NEPH_VALIDATION_OFF,
    NEPH_VALIDATION_ON,      /* core and synchronization checks; every message is counted */
    NEPH_VALIDATION_SHADERS, /* synchronization checks, and checks that the layer adds to shaders:
                                their reads and writes at run time; every error is counted */
};

struct neph_vulkan_params {
    enum neph_vulkan_validation validation;
    const char *device; /* part of the device name, in any case; NULL: a CPU device (lavapipe) if
                           present, since every machine can have it, else the first */
    /* Borrowed; folder for specialised shaders and the driver's compiled pipelines, created if
     * missing. NULL: nothing is kept. */
    const char *cache_folder;
};

/* Open a device with a compute queue. NULL params: all zero. Free with _destroy.
 * NEPH_ERR_UNAVAILABLE: no loader, no driver, no such device, no device that meets the requirements
 * (requirements.h), or validation is requested and not installed; the hint is the way out, such as
 * the command that installs the missing part. */
enum neph_status neph_vulkan_create(const struct neph_vulkan_params *params,
                                    struct neph_vulkan **vulkan, struct neph_diag *diag);

/* NULL is fine. Returns the number of validation messages since creation, including those at the
 * end about objects never freed. For tests; other callers ignore it. */
int neph_vulkan_destroy(struct neph_vulkan *vulkan);

struct neph_vulkan_description neph_vulkan_describe(const struct neph_vulkan *vulkan);

/* The requirements that were checked, with the device's values. Returns the number of `answers`. */
int neph_vulkan_requirements(const struct neph_vulkan *vulkan,
                             struct neph_vulkan_requirement answers[NEPH_VULKAN_REQUIREMENTS_MAX]);

/* NEPH_ERR_INTERNAL with the text of the first validation message of warning or above, if any. */
enum neph_status neph_vulkan_check(const struct neph_vulkan *vulkan, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A Vulkan 1.2 device for compute. Nothing is linked: the loader is opened at run time (volk), so
 * a machine without Vulkan gets a sentence and an install line instead of a dynamic-linker error.
 *
 * Threads: a neph_vulkan is used by one thread at a time; create them one after the other. It makes
 * its kernels on threads of its own.
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
    NEPH_VALIDATION_SHADERS, /* synchronization checks, and those that the layer adds to shaders:
                              * what they read and write, as they run; every error is counted */
};

struct neph_vulkan_params {
    enum neph_vulkan_validation validation;
    const char *device; /* part of the device name, in any case; NULL: a CPU device (lavapipe) when
                         * there is one, since every machine can have it, else the first */
    /* Borrowed; for specialised shaders and the driver's compiled pipelines; made if need be. NULL:
     * nothing is kept. */
    const char *cache_folder;
};

/* Open a device with a compute queue. NULL params: all zero. Free with _destroy.
 * NEPH_ERR_UNAVAILABLE: no loader, no driver, no such device, none that has what is required
 * (requirements.h), or validation is asked for and not installed; the hint is the way out, such as
 * the line that installs what is missing. */
enum neph_status neph_vulkan_create(const struct neph_vulkan_params *params,
                                    struct neph_vulkan **vulkan, struct neph_diag *diag);

/* NULL is fine. Returns the validation messages of its whole life, among them those that only the
 * end can bring: objects never freed. Ignore it unless you are a test. */
int neph_vulkan_destroy(struct neph_vulkan *vulkan);

struct neph_vulkan_description neph_vulkan_describe(const struct neph_vulkan *vulkan);

/* What it was asked for before it was opened. Returns how many `answers` there are. */
int neph_vulkan_requirements(const struct neph_vulkan *vulkan,
                             struct neph_vulkan_requirement answers[NEPH_VULKAN_REQUIREMENTS_MAX]);

/* NEPH_ERR_INTERNAL with the text of the first validation message of warning or above, when there
 * was any. */
enum neph_status neph_vulkan_check(const struct neph_vulkan *vulkan, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The Vulkan device that our own engines run on, as the environment names it, and how the jobs of a
 * process share one.
 */
#ifndef NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H
#define NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H

#include "harness/engines/engine.h"
#include "renderer/vulkan.h"

/* NEPH_VULKAN_DEVICE: a part of the device's name. NEPH_VULKAN_VALIDATION=1: with the validation
 * layers; =shaders: with their checks in shaders. The name is the environment's own string. */
struct neph_vulkan_params neph_vulkan_device_params(void);

/* That device, with what it compiles kept in the cache (neph_cache_path()). Errors as of
 * neph_vulkan_create(). */
enum neph_status neph_vulkan_open(struct neph_vulkan **vulkan, struct neph_diag *diag);

/* An open device with its kernels, destroyed with its last user. */
struct neph_open_device {
    struct neph_vulkan *vulkan;
    int user_count; /* sequences, and the neph_shared_device that keeps it for the next one */
};

/* What the jobs of a command hand to their engines (neph_shot.device): the device is opened at the
 * first need and kept with its kernels. Zero-initialise it; end it with _close before the process
 * forks (the child opens its own) and at the end. Only one thread uses it. */
struct neph_shared_device {
    struct neph_open_device *open; /* NULL: not open */
};

/* A device for one user, to release. In place of a device that was lost, or on which validation has
 * had a message, a new one is opened; other users keep the old one. `shared` NULL: a device that
 * nobody else gets. Errors as of neph_vulkan_open(). */
enum neph_status neph_device_acquire(struct neph_shared_device *shared,
                                     struct neph_open_device **device, struct neph_diag *diag);

/* NULL is fine. */
void neph_device_release(struct neph_open_device *device);

/* The next user gets a new device. NULL is fine. */
void neph_shared_device_close(struct neph_shared_device *shared);

/* neph_engine.probe of an engine that needs nothing but the device. */
void neph_vulkan_probe(const struct neph_engine *engine, struct neph_shared_device *shared,
                       struct neph_engine_info *info);

#endif

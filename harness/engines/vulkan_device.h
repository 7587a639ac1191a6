/* SPDX-License-Identifier: MIT
 *
 * The Vulkan device of the built-in engines, chosen by the environment, and how the jobs of a
 * process share it.
 */
#ifndef NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H
#define NEPH_HARNESS_ENGINES_VULKAN_DEVICE_H

#include "harness/engines/engine.h"
#include "renderer/vulkan.h"

/* The device's parameters from the environment. NEPH_VULKAN_DEVICE: a part of the device's name.
 * NEPH_VULKAN_VALIDATION=1: with the validation layers; =shaders: with their shader checks. The
 * name points into the environment. */
struct neph_vulkan_params neph_vulkan_device_params(void);

/* Open that device; compiled shaders are kept in the cache (neph_cache_path()). Errors as of
 * neph_vulkan_create(). */
enum neph_status neph_vulkan_open(struct neph_vulkan **vulkan, struct neph_diag *diag);

/* An open device with its kernels; destroyed with its last user. */
struct neph_open_device {
    struct neph_vulkan *vulkan;
    int user_count; /* sequences, and the neph_shared_device that keeps it open */
};

/* The device that the jobs of a command share (neph_shot.device). It is opened when first needed
 * and kept with its kernels. Initialise with zeros; end with neph_shared_device_close() before a
 * fork (the child opens its own) and at the end. For one thread only. */
struct neph_shared_device {
    struct neph_open_device *open; /* NULL: not open */
};

/* Acquire a device for one user; end with neph_device_release(). A device that was lost, or for
 * which validation reported a message, is replaced by a new one; other users keep the old one.
 * `shared` NULL: a device that is not shared. Errors as of neph_vulkan_open(). */
enum neph_status neph_device_acquire(struct neph_shared_device *shared,
                                     struct neph_open_device **device, struct neph_diag *diag);

/* `device` may be NULL. */
void neph_device_release(struct neph_open_device *device);

/* Close the shared device; the next user gets a new one. `shared` may be NULL. */
void neph_shared_device_close(struct neph_shared_device *shared);

/* neph_engine.probe for engines that need only the device. */
void neph_vulkan_probe(const struct neph_engine *engine, struct neph_shared_device *shared,
                       struct neph_engine_info *info);

#endif

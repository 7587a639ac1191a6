/* SPDX-License-Identifier: MIT
 *
 * How much memory of devices the process has, buffers and textures together: what a frame needs is
 * told beside its time.
 */
#ifndef NEPH_RENDERER_DEVICE_MEMORY_H
#define NEPH_RENDERER_DEVICE_MEMORY_H

#include <stdint.h>

/* For those who allocate and free it. */
void neph_device_memory_take(uint64_t bytes);
void neph_device_memory_give(uint64_t bytes);

/* Now, and the most since neph_device_memory_watch(). From any thread. */
uint64_t neph_device_memory(void);
uint64_t neph_device_memory_most(void);
void neph_device_memory_watch(void);

#endif

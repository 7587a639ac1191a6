/* SPDX-License-Identifier: MIT
 *
 * Counters of the device memory that the process has allocated, buffers and textures together.
 * Reported beside the time of a frame.
 */
#ifndef NEPH_RENDERER_DEVICE_MEMORY_H
#define NEPH_RENDERER_DEVICE_MEMORY_H

#include <stdint.h>

/* Called by the code that allocates and frees device memory. */
void neph_device_memory_add(uint64_t bytes);
void neph_device_memory_subtract(uint64_t bytes);

/* The current size, and the maximum since neph_device_memory_reset_peak() [bytes]. From any thread.
 * */
uint64_t neph_device_memory(void);
uint64_t neph_device_memory_peak(void);
void neph_device_memory_reset_peak(void);

#endif

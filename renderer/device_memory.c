/* SPDX-License-Identifier: MIT */
#include "renderer/device_memory.h"

#include <stdatomic.h>

static _Atomic uint64_t taken, most;

void neph_device_memory_add(uint64_t bytes)
{
    const uint64_t now = atomic_fetch_add(&taken, bytes) + bytes;
    uint64_t before = atomic_load(&most);
    while (now > before && !atomic_compare_exchange_weak(&most, &before, now))
        continue;
}

void neph_device_memory_subtract(uint64_t bytes)
{
    atomic_fetch_sub(&taken, bytes);
}

uint64_t neph_device_memory(void)
{
    return atomic_load(&taken);
}

uint64_t neph_device_memory_peak(void)
{
    return atomic_load(&most);
}

void neph_device_memory_reset_peak(void)
{
    atomic_store(&most, atomic_load(&taken));
}

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/tuning.h"

#include "renderer/realtime/shared/names.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_RT_DEVICE_KINDS == 2, "a new kind");

static const struct neph_rt_tuning tunings[NEPH_RT_DEVICE_KINDS] = {
    [NEPH_RT_CPU] = {.composition = RT_COMPOSITION_UPSCALE,
                     .has_air_kernels = true,
                     .elides_outputs = true},
    [NEPH_RT_GPU] = {.composition = RT_COMPOSITION_TAA,
                     .has_driver_halves = true,
                     .prepares_kernels = true},
};

const struct neph_rt_tuning *neph_rt_get_tuning(enum neph_rt_device_kind kind)
{
    return &tunings[kind];
}

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/ray_march/ray_march.comp.inc"
};

const struct neph_rt_pass neph_rt_ray_march = {
    .name = "march",
    .note = "a ray per tile through the media",
    .shader = {"ray_march", code, sizeof(code), .block = {RT_MARCH_BLOCK, RT_MARCH_BLOCK}},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .resolution = RT_QUARTER,
    .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
    .reads = NEPH_RT_BIT(RT_TILE) | NEPH_RT_BIT(RT_HALF_DEPTH),
    .writes = NEPH_RT_BIT(RT_RAY) | NEPH_RT_BIT(RT_RAY_DISTANCE),
};

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

const struct neph_rt_pass neph_rt_oracle_texels = {
    .name = "oracle texels",
    .note = "a ray per half-resolution texel",
    .shader = {"ray_march", code, sizeof(code)},
    .condition = {RT_ORACLE, RT_ORACLE_ON},
    .resolution = RT_HALF,
    .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
    .role = RT_ROLE_ORACLE,
    .reads = NEPH_RT_BIT(RT_HALF_DEPTH),
    .writes = NEPH_RT_BIT(RT_HISTORY) | NEPH_RT_BIT(RT_HISTORY_STATE),
};

const struct neph_rt_pass neph_rt_oracle_pixels = {
    .name = "oracle pixels",
    .note = "a ray per pixel, minus these",
    .shader = {"ray_march", code, sizeof(code)},
    .condition = {RT_ORACLE_UPSCALE, 1},
    .resolution = RT_FULL,
    .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
    .role = RT_ROLE_PIXELS,
    .reads = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_VOLUME),
    .writes = NEPH_RT_BIT(RT_VOLUME),
};

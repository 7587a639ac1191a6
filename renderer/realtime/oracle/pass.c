/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t texels_code[] = {
#include "realtime/oracle/oracle_texels.comp.inc"
};

static const uint32_t spread_code[] = {
#include "realtime/oracle/oracle_spread.comp.inc"
};

static const uint32_t pixels_code[] = {
#include "realtime/oracle/oracle_pixels.comp.inc"
};

const struct neph_rt_pass neph_rt_oracle_texels = {
    .name = "oracle texels",
    .note = "a ray per half-resolution texel",
    .shader = {"oracle_texels", texels_code, sizeof(texels_code)},
    .condition = {RT_ORACLE, RT_ORACLE_ON},
    .resolution = RT_HALF,
    .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
    .reads = NEPH_RT_BIT(RT_HALF_DEPTH),
    .writes = NEPH_RT_BIT(RT_HISTORY) | NEPH_RT_BIT(RT_HISTORY_STATE),
};

const struct neph_rt_pass neph_rt_oracle_spread = {
    .name = "oracle spread",
    .note = "these rays at full resolution",
    .shader = {"oracle_spread", spread_code, sizeof(spread_code)},
    .condition = {RT_ORACLE_UPSCALE, 1},
    .resolution = RT_FULL,
    .in_quads = true,
    .reads = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_HISTORY) |
             NEPH_RT_BIT(RT_HISTORY_BEFORE) | NEPH_RT_BIT(RT_HISTORY_STATE),
    .spared = {{{{RT_ATROUS, 1}}, NEPH_RT_BIT(RT_HISTORY_BEFORE)}},
    .writes = NEPH_RT_BIT(RT_VOLUME),
};

const struct neph_rt_pass neph_rt_oracle_pixels = {
    .name = "oracle pixels",
    .note = "a ray per pixel, minus these",
    .shader = {"oracle_pixels", pixels_code, sizeof(pixels_code)},
    .condition = {RT_ORACLE_UPSCALE, 1},
    .resolution = RT_FULL,
    .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
    .reads = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_VOLUME),
    .writes = NEPH_RT_BIT(RT_VOLUME),
};

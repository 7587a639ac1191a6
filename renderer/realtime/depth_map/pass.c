/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/depth_map/depth_map.comp.inc"
};

const struct neph_rt_pass neph_rt_depth_map = {
    .name = "depth map",
    .note = "one of 2x2 depths",
    .shader = {"depth_map", code, sizeof(code)},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .done_by_other = {{RT_DEPTH_MAP_PASS, RT_DEPTH_MAP_PASS_TILE_INDEX}},
    .resolution = RT_HALF,
    .reads = NEPH_RT_BIT(RT_STEADY_DEPTH),
    .writes = NEPH_RT_BIT(RT_HALF_DEPTH),
    .histories = {{RT_HALF_DEPTH, RT_HALF_DEPTH_BEFORE}},
};

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/tile_index/tile_index.comp.inc"
};

static const uint32_t gpu_code[] = {
#include "realtime/tile_index/tile_index_gpu.comp.inc"
};

const struct neph_rt_pass neph_rt_tile_index = {
    .name = "tile index",
    .note = "the half-resolution texel, of 2x2, that each tile marches",
    .shader = {"tile_index", code, sizeof(code)},
    .variants = {[NEPH_RT_GPU] = {"tile_index_gpu", gpu_code, sizeof(gpu_code),
                                  .block = {RT_COLOUR_BLOCK, RT_COLOUR_BLOCK},
                                  .needs = {{RT_OVERRIDE, RT_OVERRIDE_SEQUENTIAL},
                                            {RT_GATHER, RT_GATHER_TEXEL},
                                            {RT_TILE_ORIGIN, RT_TILE_ORIGIN_VIEW}},
                                  .absorbs = &neph_rt_depth_map}},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .resolution = RT_QUARTER,
    .in_colours = &(const struct neph_rt_condition){RT_OVERRIDE, RT_OVERRIDE_SEQUENTIAL},
    .reads = NEPH_RT_BIT(RT_STEADY_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_TILE),
    .spared = {{{{RT_DEPTH_MAP_PASS, RT_DEPTH_MAP_PASS_TILE_INDEX}}, NEPH_RT_BIT(RT_STEADY_DEPTH)}},
    .writes = NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_TILE),
};

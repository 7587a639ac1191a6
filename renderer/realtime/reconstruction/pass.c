/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/reconstruction/reconstruct.comp.inc"
};

static const uint32_t gpu_code[] = {
#include "realtime/reconstruction/reconstruct_gpu.comp.inc"
};

const struct neph_rt_pass neph_rt_reconstruct = {
    .name = "reconstruction",
    .note = "rays and the reprojected history at half resolution",
    .shader = {"reconstruct", code, sizeof(code)},
    .variants = {[NEPH_RT_GPU] = {"reconstruct_gpu", gpu_code, sizeof(gpu_code),
                                  .block = {RT_TEXEL_BLOCK_WIDTH, RT_TEXEL_BLOCK_HEIGHT},
                                  .needs = {{RT_EDGE_TILES, RT_EDGE_TILES_KEPT},
                                            {RT_GATHER, RT_GATHER_TEXEL}},
                                  .absorbs = &neph_rt_change}},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .resolution = RT_HALF,
    .unread_resolution = RT_QUARTER,
    .reads = NEPH_RT_BIT(RT_TILE) | NEPH_RT_BIT(RT_RAY) | NEPH_RT_BIT(RT_RAY_DISTANCE) |
             NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH_BEFORE) |
             NEPH_RT_BIT(RT_HISTORY_BEFORE) | NEPH_RT_BIT(RT_HISTORY_STATE_BEFORE) |
             NEPH_RT_BIT(RT_CHANGE) | NEPH_RT_CHANGE_READS,
    .spared = {{{{RT_GRADIENT, 1}}, NEPH_RT_BIT(RT_CHANGE)},
               {{{RT_CHANGE_PASS, RT_CHANGE_PASS_RECONSTRUCTION}}, NEPH_RT_CHANGE_READS},
               {{{RT_STEADY, RT_STEADY_KNOWN}, {RT_STEADY, RT_STEADY_UNREAD}},
                NEPH_RT_BIT(RT_KEPT_RAY)}},
    .writes = NEPH_RT_BIT(RT_HISTORY) | NEPH_RT_BIT(RT_HISTORY_STATE) | NEPH_RT_BIT(RT_CHANGE) |
              NEPH_RT_BIT(RT_CHANGE_BEHIND) | NEPH_RT_BIT(RT_KEPT_RAY),
    .replaces = NEPH_RT_BIT(RT_HISTORY) | NEPH_RT_BIT(RT_HISTORY_STATE),
    .histories = {{RT_HISTORY, RT_HISTORY_BEFORE}, {RT_HISTORY_STATE, RT_HISTORY_STATE_BEFORE}},
};

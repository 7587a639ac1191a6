/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/upscale/upscale.comp.inc"
};

static const uint32_t gpu_code[] = {
#include "realtime/upscale/upscale_gpu.comp.inc"
};

const struct neph_rt_pass neph_rt_upscale = {
    .name = "upscale",
    .note = "the volume at full resolution, guided by depth",
    .shader = {"upscale", code, sizeof(code)},
    .variants = {[NEPH_RT_GPU] = {"upscale_gpu", gpu_code, sizeof(gpu_code),
                                  .needs = {{RT_TARGET_FORMAT, RT_FORMAT_HALF}}}},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .resolution = RT_FULL,
    .in_quads = true,
    .reads = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_HISTORY) |
             NEPH_RT_BIT(RT_HISTORY_BEFORE) | NEPH_RT_BIT(RT_HISTORY_STATE) |
             NEPH_RT_BIT(RT_BEHIND),
    .spared = {{{{RT_ATROUS, 0}}, NEPH_RT_BIT(RT_HISTORY)},
               {{{RT_ATROUS, 1}}, NEPH_RT_BIT(RT_HISTORY_BEFORE)},
               {{{RT_COMPOSITION, RT_COMPOSITION_UPSCALE}},
                NEPH_RT_BIT(RT_BEHIND) | NEPH_RT_BIT(RT_COLOR)},
               {{{RT_STEADY, RT_STEADY_ASKED}, {RT_STEADY, RT_STEADY_KNOWN}},
                NEPH_RT_BIT(RT_VOLUME) | NEPH_RT_BIT(RT_VOLUME_DISTANCE)}},
    .writes = NEPH_RT_BIT(RT_VOLUME) | NEPH_RT_BIT(RT_VOLUME_DISTANCE) | NEPH_RT_BIT(RT_COLOR),
    .replaces = NEPH_RT_BIT(RT_VOLUME),
    .picture = RT_COLOR,
};

const struct neph_rt_pass neph_rt_oracle_spread = {
    .name = "oracle spread",
    .note = "the texels' own rays at full resolution",
    .shader = {"upscale", code, sizeof(code)},
    .condition = {RT_ORACLE_UPSCALE, 1},
    .resolution = RT_FULL,
    .in_quads = true,
    .role = RT_ROLE_ORACLE,
    .reads = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_HISTORY) |
             NEPH_RT_BIT(RT_HISTORY_BEFORE) | NEPH_RT_BIT(RT_HISTORY_STATE),
    .spared = {{{{RT_ATROUS, 1}}, NEPH_RT_BIT(RT_HISTORY_BEFORE)}},
    .writes = NEPH_RT_BIT(RT_VOLUME),
};

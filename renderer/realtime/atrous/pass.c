/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

#define ATROUS_READS NEPH_RT_BIT(RT_HALF_DEPTH) | NEPH_RT_BIT(RT_HISTORY_STATE)

static const uint32_t atrous_1_code[] = {
#include "realtime/atrous/atrous_1.comp.inc"
};

const struct neph_rt_pass neph_rt_atrous_1 = {
    .name = "a-trous 1",
    .note = "the volume filtered by depth and luma",
    .shader = {"atrous_1", atrous_1_code, sizeof(atrous_1_code)},
    .condition = {RT_ATROUS, 1},
    .resolution = RT_HALF,
    .reads = NEPH_RT_BIT(RT_HISTORY) | ATROUS_READS,
    .writes = NEPH_RT_BIT(RT_HISTORY_BEFORE),
};

static const uint32_t atrous_2_code[] = {
#include "realtime/atrous/atrous_2.comp.inc"
};

const struct neph_rt_pass neph_rt_atrous_2 = {
    .name = "a-trous 2",
    .note = "the same with texels two apart",
    .shader = {"atrous_2", atrous_2_code, sizeof(atrous_2_code)},
    .condition = {RT_ATROUS, 1},
    .resolution = RT_HALF,
    .reads = NEPH_RT_BIT(RT_HISTORY_BEFORE) | ATROUS_READS,
    .writes = NEPH_RT_BIT(RT_KEPT_RAY),
};

static const uint32_t atrous_4_code[] = {
#include "realtime/atrous/atrous_4.comp.inc"
};

const struct neph_rt_pass neph_rt_atrous_4 = {
    .name = "a-trous 4",
    .note = "the same with texels four apart",
    .shader = {"atrous_4", atrous_4_code, sizeof(atrous_4_code)},
    .condition = {RT_ATROUS, 1},
    .resolution = RT_HALF,
    .reads = NEPH_RT_BIT(RT_KEPT_RAY) | ATROUS_READS,
    .writes = NEPH_RT_BIT(RT_HISTORY_BEFORE),
};

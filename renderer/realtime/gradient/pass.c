/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t gradient_code[] = {
#include "realtime/gradient/gradient.comp.inc"
};

const struct neph_rt_pass neph_rt_gradient = {
    .name = "gradient",
    .note = "differences of rays that are marched twice",
    .shader = {"gradient", gradient_code, sizeof(gradient_code)},
    .condition = {RT_GRADIENT, 1},
    .done_by_other = {{RT_STEADY, RT_STEADY_KNOWN}, {RT_STEADY, RT_STEADY_UNREAD}},
    .resolution = RT_QUARTER,
    .reads = NEPH_RT_BIT(RT_RAY) | NEPH_RT_BIT(RT_BEHIND) | NEPH_RT_BIT(RT_KEPT_RAY) |
             NEPH_RT_BIT(RT_KEPT_BEHIND) | NEPH_RT_BIT(RT_HALF_DEPTH) |
             NEPH_RT_BIT(RT_HALF_DEPTH_BEFORE),
    .writes = NEPH_RT_BIT(RT_KEPT_RAY) | NEPH_RT_BIT(RT_KEPT_BEHIND) | NEPH_RT_BIT(RT_LOOK_NOW) |
              NEPH_RT_BIT(RT_LOOK_THEN) | NEPH_RT_BIT(RT_LOOK_BEHIND_NOW) |
              NEPH_RT_BIT(RT_LOOK_BEHIND_THEN),
};

static const uint32_t change_code[] = {
#include "realtime/gradient/change.comp.inc"
};

const struct neph_rt_pass neph_rt_change = {
    .name = "change",
    .note = "change of the light around a tile",
    .shader = {"change", change_code, sizeof(change_code)},
    .condition = {RT_GRADIENT, 1},
    .done_by_other = {{RT_CHANGE_PASS, RT_CHANGE_PASS_RECONSTRUCTION},
                      {RT_STEADY, RT_STEADY_KNOWN},
                      {RT_STEADY, RT_STEADY_UNREAD}},
    .resolution = RT_QUARTER,
    .reads = NEPH_RT_CHANGE_READS | NEPH_RT_BIT(RT_CHANGE),
    .writes = NEPH_RT_BIT(RT_CHANGE) | NEPH_RT_BIT(RT_CHANGE_BEHIND),
};

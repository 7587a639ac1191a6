/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/composition/compose.comp.inc"
};

const struct neph_rt_pass neph_rt_compose = {
    .name = "composition",
    .note = "the volume composed with the background",
    .shader = {"compose", code, sizeof(code)},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .done_by_other = {{RT_COMPOSITION, RT_COMPOSITION_TAA},
                      {RT_COMPOSITION, RT_COMPOSITION_UPSCALE}},
    .resolution = RT_FULL,
    .reads = NEPH_RT_BIT(RT_VOLUME) | NEPH_RT_BIT(RT_BEHIND),
    .writes = NEPH_RT_BIT(RT_COLOR),
    .picture = RT_COLOR,
};

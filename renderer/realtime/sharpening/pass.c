/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/sharpening/sharpen.comp.inc"
};

const struct neph_rt_pass neph_rt_sharpen = {
    .name = "sharpening",
    .note = "against the blur of anti-aliasing",
    .shader = {"sharpen", code, sizeof(code)},
    .condition = {RT_SHARPEN, 1},
    .resolution = RT_OUTPUT,
    .reads = NEPH_RT_BIT(RT_COLOR) | NEPH_RT_BIT(RT_TAA_OUT),
    .writes = NEPH_RT_BIT(RT_SHARPENED),
    .picture = RT_SHARPENED,
};

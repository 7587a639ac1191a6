/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shaders.h"

static const uint32_t min_max_spirv[] = {
#include "shaders/rt_min_max.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_min_max = {"rt_min_max", min_max_spirv,
                                                      sizeof(min_max_spirv)};

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shaders.h"

static const uint32_t min_max_spirv[] = {
#include "shaders/rt_min_max.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_min_max = {"rt_min_max", min_max_spirv,
                                                      sizeof(min_max_spirv)};

static const uint32_t tile_index_spirv[] = {
#include "shaders/rt_tile_index.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_tile_index = {"rt_tile_index", tile_index_spirv,
                                                         sizeof(tile_index_spirv)};

static const uint32_t reconstruct_spirv[] = {
#include "shaders/rt_reconstruct.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_reconstruct = {"rt_reconstruct", reconstruct_spirv,
                                                          sizeof(reconstruct_spirv)};

static const uint32_t upscale_spirv[] = {
#include "shaders/rt_upscale.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_upscale = {"rt_upscale", upscale_spirv,
                                                      sizeof(upscale_spirv)};

static const uint32_t compose_spirv[] = {
#include "shaders/rt_compose.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_compose = {"rt_compose", compose_spirv,
                                                      sizeof(compose_spirv)};

static const uint32_t taa_spirv[] = {
#include "shaders/rt_taa.comp.inc"
};
const struct neph_rt_shader neph_rt_shader_taa = {"rt_taa", taa_spirv, sizeof(taa_spirv)};

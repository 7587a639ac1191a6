/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/scene_rays/scene_rays.comp.inc"
};

const struct neph_rt_pass neph_rt_scene_rays = {
    .name = "scene",
    .note = "depth, and radiance behind all media, a ray per pixel",
    .shader = {"scene_rays", code, sizeof(code)},
    .condition = {RT_SPLIT, RT_SPLIT_FOUR},
    .resolution = RT_FULL,
    .rays = NEPH_RT_RAYS_TO_SOLIDS,
    .writes = NEPH_RT_BIT(RT_DEPTH) | NEPH_RT_BIT(RT_BEHIND) | NEPH_RT_BIT(RT_STEADY_DEPTH),
};

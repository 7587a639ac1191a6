/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

static const uint32_t code[] = {
#include "realtime/solid_motion/solid_motion.comp.inc"
};

const struct neph_rt_pass neph_rt_solid_motion = {
    .name = "motion",
    .note = "motion vectors of moving solids, a ray per pixel",
    .shader = {"solid_motion", code, sizeof(code)},
    .condition = {RT_SOLID_MOTION, 1},
    .resolution = RT_FULL,
    .rays = NEPH_RT_RAYS_TO_SOLIDS,
    .writes = NEPH_RT_BIT(RT_MOVED),
};

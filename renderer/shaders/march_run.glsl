// SPDX-License-Identifier: MIT
//
// Push constants of a march: the rays (one per thread) and the steps that one dispatch computes
// (renderer/march_split.h).
#ifndef NEPH_MARCH_RUN_GLSL
#define NEPH_MARCH_RUN_GLSL

layout(local_size_x = 64) in;

layout(push_constant) uniform MarchRun {
    uint first_ray;
    uint ray_count;
    uint first_step;
    uint end_step;
} run;

#endif

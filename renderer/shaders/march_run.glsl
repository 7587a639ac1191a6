// SPDX-License-Identifier: MIT
//
// The piece of a march that one dispatch does: some of its rays, one a thread, and some of their
// steps (renderer/march_cut.h).
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

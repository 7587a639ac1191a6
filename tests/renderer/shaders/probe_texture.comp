#version 450
// SPDX-License-Identifier: MIT
//
// Extinction of a medium at a point, as sampled for sums over steps
// (renderer/shaders/grid_texture.glsl), for tests/renderer/test_grid_texture.c: one thread is one
// point.
#extension GL_GOOGLE_include_directive : require

#include "grid_texture.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 5) readonly buffer Points {
    vec4 points[]; // relative to the camera; w: the medium
};

layout(std430, binding = 6) writeonly buffer Answers {
    float answers[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < points.length())
        answers[i] = points[i].w == 0.0 ? sampled_extinction_per_m(0, points[i].xyz)
                                        : sampled_extinction_per_m(1, points[i].xyz);
}

#version 450
// SPDX-License-Identifier: MIT
//
// Points of renderer/shaders/low_discrepancy.glsl, for tests/renderer/test_low_discrepancy.c: one
// thread is one point.
#extension GL_GOOGLE_include_directive : require

#include "low_discrepancy.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform SobolRun {
    uvec4 key;
    uint first;
    uint padding[3];
} run;

layout(std430, binding = 0) writeonly buffer Answers {
    uvec2 answers[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    answers[i] = sobol_pair(run.first + i, run.key);
}

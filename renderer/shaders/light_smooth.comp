#version 450
// SPDX-License-Identifier: MIT
//
// Spatial filter of traced light (traced_light.glsl): a Gaussian over neighbouring texels, one
// thread per texel. It adds sums, not means, so a texel with more paths has more weight.
#extension GL_GOOGLE_include_directive : require

#include "traced_light.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform LightSmooth {
    uvec2 size; // texels
    float sigma; // standard deviation in texels; 0: no filter
} run;

layout(std430, binding = 0) readonly buffer Settled {
    LightTexel settled[];
};

layout(std430, binding = 1) writeonly buffer Smoothed {
    vec4 smoothed[]; // rgb light, a collisions
};

const int REACH = 3; // radius of the kernel, in texels

void main()
{
    uint texel = gl_GlobalInvocationID.x;
    if (texel >= run.size.x * run.size.y)
        return;
    ivec2 at = ivec2(texel % run.size.x, texel / run.size.x);
    ivec2 low = max(at - REACH, ivec2(0)), high = min(at + REACH, ivec2(run.size) - 1);
    float falloff = run.sigma > 0.0 ? 0.5 / (run.sigma * run.sigma) : 100.0;
    vec4 sum = vec4(0.0);
    for (int y = low.y; y <= high.y; y++)
        for (int x = low.x; x <= high.x; x++) {
            vec2 away = vec2(x, y) - vec2(at);
            LightTexel other = settled[uint(x) + run.size.x * uint(y)];
            sum += exp(max(-falloff * dot(away, away), EXPONENT_MIN)) *
                   vec4(other.light, other.collisions);
        }
    smoothed[texel] = sum;
}

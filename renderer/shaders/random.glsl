// SPDX-License-Identifier: MIT
//
// Random numbers without memory: the n-th number of a sample is a hash of (seed, pixel, sample, n),
// so it does not matter which thread asks for it, or when.
//
// pcg3d, pcg4d: M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
#ifndef NEPH_RANDOM_GLSL
#define NEPH_RANDOM_GLSL

#include "numbers.glsl"

uvec3 pcg3d(uvec3 v)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

uvec4 pcg4d(uvec4 v)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// In (0, 1), never 0 or 1: 23 bits at the middles of their steps. (With 24 bits the last middle is
// no float32 and rounds to 1.)
vec3 uniform_from(uvec3 bits)
{
    return (vec3(bits >> 9) + 0.5) * exp2(-23.0);
}

// Exponentially distributed with mean 1, from 32 bits. Fine near 0, where thin media decide, and
// up to 22.9 (beyond lies 1e-10 of the distribution): a 24-bit uniform would be coarse at one end.
float exponential_from(uint bits)
{
    float below = (float(~bits) + 0.5) * exp2(-32.0); // 1 - u
    float u = (float(bits) + 0.5) * exp2(-32.0);
    return below < 0.3 ? -log_1_plus_small(-below) : -log(u);
}

#endif

// SPDX-License-Identifier: MIT
//
// Counter-based random numbers: the n-th number of a sample is a hash of (seed, pixel, sample, n).
// It does not depend on the thread or on the order of evaluation.
//
// pcg3d, pcg4d: M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
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

// Uniform in the open interval (0, 1): the midpoints of 2^23 equal steps. With 24 bits the last
// midpoint is no float32 and would round to 1.
vec3 uniform_from(uvec3 bits)
{
    return (vec3(bits >> 9) + 0.5) * exp2(-23.0);
}

// Exponential distribution with mean 1, from 32 bits. It is fine near 0, which matters for thin
// media, and reaches up to 22.9, beyond which the probability is 1e-10. A 24-bit uniform number
// would be coarse at one of the ends.
float exponential_from(uint bits)
{
    float below = (float(~bits) + 0.5) * exp2(-32.0); // 1 - u, accurate near 0
    float u = (float(bits) + 0.5) * exp2(-32.0);
    return below < 0.3 ? -log_1_plus_small(-below) : -log(u);
}

#endif

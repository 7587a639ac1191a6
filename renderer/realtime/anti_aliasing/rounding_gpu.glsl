// SPDX-License-Identifier: MIT
//
// rounding.glsl for a GPU, on integers, with the same choice for values >= 0: a random 13-bit
// number is added to the 13 bits that a half lacks, and a carry rounds away from 0. Values below
// 2^-14 are first increased by 2^-14, where float32 has a spacing of 2^-37.
#ifndef NEPH_REALTIME_ROUNDING_GPU_GLSL
#define NEPH_REALTIME_ROUNDING_GPU_GLSL

#include "renderer/shaders/random.glsl"

const float LEAST_NORMAL = 6.103515625e-5; // 2^-14

float round_by_chance(float value, uint bits)
{
    float magnitude = abs(value);
    bool is_below_normal = magnitude < LEAST_NORMAL;
    precise float above = magnitude + LEAST_NORMAL;
    uint sum = floatBitsToUint(is_below_normal ? above : magnitude) + (~bits >> 19);
    float rounded = uintBitsToFloat(sum & ~0x1fffu);
    rounded = is_below_normal ? rounded - LEAST_NORMAL : rounded;
    return value < 0.0 ? -rounded : rounded;
}

#endif

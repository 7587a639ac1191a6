#version 450
// SPDX-License-Identifier: MIT
//
// Tests the driver's conversions between float32 and half (packHalf2x16, unpackHalf2x16) against
// halves.glsl. Each thread tests one of the 65536 halves: reading it, and writing it and the floats
// around the middle between it and the next half, where rounding to nearest decides. A NaN must
// only stay a NaN. renderer/halves.c reads the verdict.
#extension GL_GOOGLE_include_directive : require

#include "halves.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) buffer Verdict {
    uint wrong; // NEPH_HALVES_READ, NEPH_HALVES_WRITTEN: conversions that are wrong
} verdict;

const uint INFINITE_HALF = 0x7c00u, INFINITE = 0x7f800000u;

bool is_nan(float value) { return (floatBitsToUint(value) & 0x7fffffffu) > INFINITE; }

bool reads(uint half_bits)
{
    float expected = from_half(half_bits);
    vec2 found = unpackHalf2x16(half_bits | half_bits << 16);
    if (is_nan(expected))
        return is_nan(found.x) && is_nan(found.y);
    return floatBitsToUint(found.x) == floatBitsToUint(expected) &&
           floatBitsToUint(found.y) == floatBitsToUint(expected);
}

bool writes(float value)
{
    uint expected = to_half(value);
    return packHalf2x16(vec2(value)) == (expected | expected << 16);
}

// The half itself as a float, and the floats at, below and above the middle to the next half. Above
// the largest half the next one would be 2^16.
bool writes_about(uint half_bits)
{
    uint sign = (half_bits & 0x8000u) << 16, magnitude = half_bits & 0x7fffu;
    if (magnitude > INFINITE_HALF)
        return is_nan(unpackHalf2x16(packHalf2x16(vec2(from_half(half_bits)))).x);
    if (magnitude == INFINITE_HALF)
        return writes(from_half(half_bits));
    float next = magnitude + 1u == INFINITE_HALF ? 65536.0 : from_half(magnitude + 1u);
    precise float middle = 0.5 * (from_half(magnitude) + next);
    uint bits = floatBitsToUint(middle) | sign;
    return writes(from_half(half_bits)) && writes(uintBitsToFloat(bits)) &&
           writes(uintBitsToFloat(bits - 1u)) && writes(uintBitsToFloat(bits + 1u));
}

void main()
{
    uint half_bits = gl_GlobalInvocationID.x;
    uint wrong = (reads(half_bits) ? 0u : NEPH_HALVES_READ) |
                 (writes_about(half_bits) ? 0u : NEPH_HALVES_WRITTEN);
    if (wrong != 0u)
        atomicOr(verdict.wrong, wrong);
}

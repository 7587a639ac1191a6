#version 450
// SPDX-License-Identifier: MIT
//
// What the driver's own conversions of halves are worth, asked of every half and of the floats
// about every middle between two of them, where rounding to nearest decides. NaNs must only stay
// NaNs.
#extension GL_GOOGLE_include_directive : require

#include "halves.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) buffer Verdict {
    uint wrong; // NEPH_HALVES_READ, NEPH_HALVES_WRITTEN: what is not right
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

// The half's own float, and those about the middle between it and the next one, which for the
// largest is where 2^16 would be.
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

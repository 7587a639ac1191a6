// SPDX-License-Identifier: MIT
//
// Halves by whole numbers, the same bits on every device. What the driver's own conversions are
// worth is asked by halves.comp.
#ifndef NEPH_HALVES_GLSL
#define NEPH_HALVES_GLSL

#include "constants.h"

// All ways at once and then a choice: lavapipe, for which these are, would run both sides of
// a branch.

// The nearest half, of two the even one. packHalf2x16 would leave the rounding to the driver.
uint to_half(float value)
{
    uint bits = floatBitsToUint(value), magnitude = bits & 0x7fffffffu;
    // Below 2^-14 halves are whole numbers of 2^-24, and so are floats from 1/2 to 1.
    precise float from_a_half = uintBitsToFloat(magnitude) + 0.5;
    uint below_normal = floatBitsToUint(from_a_half) - 0x3f000000u;
    uint normal = (magnitude - 0x38000000u + 0xfffu + (magnitude >> 13 & 1u)) >> 13;
    uint rounded = magnitude < 0x38800000u ? below_normal : normal;
    uint infinite = magnitude > 0x7f800000u ? 0x7e00u : 0x7c00u; // NaN; from 65520 on
    return (bits >> 16 & 0x8000u) | (magnitude >= 0x477ff000u ? infinite : rounded);
}

float from_half(uint bits)
{
    uint magnitude = (bits & 0x7fffu) << 13;
    bool is_below_normal = magnitude < 0x800000u, is_infinite = magnitude >= 0xf800000u; // or NaN
    uint exponent = is_infinite ? 0x70000000u : is_below_normal ? 0x38800000u : 0x38000000u;
    precise float below_normal = uintBitsToFloat(magnitude + exponent) - 6.103515625e-5; // 2^-14
    uint found = is_below_normal ? floatBitsToUint(below_normal) : magnitude + exponent;
    return uintBitsToFloat((bits & 0x8000u) << 16 | found);
}

// Those of a word. What is a half for a moment alone is read by this: a driver that sees its own
// two conversions follow each other may leave both out, and the value what it was.
vec2 from_halves(uint word) { return vec2(from_half(word & 0xffffu), from_half(word >> 16)); }

#endif

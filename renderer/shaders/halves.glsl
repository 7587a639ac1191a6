// SPDX-License-Identifier: MIT
//
// Conversions between float32 and half with integer arithmetic: the same bits on every device.
// halves.comp tests whether the driver's own conversions agree.
#ifndef NEPH_HALVES_GLSL
#define NEPH_HALVES_GLSL

#include "constants.h"

// Both functions compute all cases and select one of them. They are for lavapipe, which would
// execute both sides of a branch.

// Float to half, round to nearest, ties to even. packHalf2x16 leaves the rounding to the driver.
uvec2 to_halves(vec2 values)
{
    uvec2 bits = floatBitsToUint(values), magnitudes = bits & 0x7fffffffu;
    // Below 2^-14 halves are integer multiples of 2^-24, and so are floats in 1/2..1: the sum with
    // 1/2 rounds to one.
    precise vec2 from_a_half = uintBitsToFloat(magnitudes) + 0.5;
    uvec2 below_normal = floatBitsToUint(from_a_half) - 0x3f000000u;
    uvec2 normal = (magnitudes - 0x38000000u + 0xfffu + (magnitudes >> 13 & 1u)) >> 13;
    uvec2 rounded = mix(normal, below_normal, lessThan(magnitudes, uvec2(0x38800000u)));
    bvec2 are_nan = greaterThan(magnitudes, uvec2(0x7f800000u));
    uvec2 infinite = mix(uvec2(0x7c00u), uvec2(0x7e00u), are_nan); // infinity from 65520 on
    bvec2 are_infinite = greaterThanEqual(magnitudes, uvec2(0x477ff000u));
    return (bits >> 16 & 0x8000u) | mix(rounded, infinite, are_infinite);
}

uint to_half(float value) { return to_halves(vec2(value)).x; }

// Two halves packed into a word, the first in the lower half.
uint to_word(vec2 values)
{
    uvec2 halves = to_halves(values);
    return halves.x | (halves.y << 16);
}

// Half to float, four at a time in one piece of code, because it is inlined at every texel read.
vec4 from_halves(uvec4 bits)
{
    uvec4 magnitudes = (bits & 0x7fffu) << 13;
    bvec4 are_below_normal = lessThan(magnitudes, uvec4(0x800000u));
    bvec4 are_infinite = greaterThanEqual(magnitudes, uvec4(0xf800000u)); // or NaN
    uvec4 exponents = mix(mix(uvec4(0x38000000u), uvec4(0x38800000u), are_below_normal),
                          uvec4(0x70000000u), are_infinite);
    uvec4 normal = magnitudes + exponents;
    precise vec4 below_normal = uintBitsToFloat(normal) - 6.103515625e-5; // 2^-14
    uvec4 found = mix(normal, floatBitsToUint(below_normal), are_below_normal);
    return uintBitsToFloat((bits & 0x8000u) << 16 | found);
}

float from_half(uint bits) { return from_halves(uvec4(bits)).x; }

// Unpacks two words of two halves each. Values that are packed and unpacked at once go through this
// function: a driver that finds its own two conversions in sequence may remove both, and the value
// keeps its full precision.
vec4 from_words(uvec2 words)
{
    return from_halves(uvec4(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu, words.y >> 16));
}

#endif

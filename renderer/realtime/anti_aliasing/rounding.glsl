// SPDX-License-Identifier: MIT
//
// Stochastic rounding to half floats: random bits choose one of the two neighbours of a value, so
// that their mean is the value v: with the distance s of halves at v,
//
//     P(s floor(v / s) + s) = v / s - floor(v / s),   else s floor(v / s)
//
// A history that is rounded to nearest stalls before its limit. A float has 13 bits more than a
// half: the upper 13 random bits decide.
// (Unreal adds up to one step and leaves the rounding to the hardware.)
#ifndef NEPH_REALTIME_ROUNDING_GLSL
#define NEPH_REALTIME_ROUNDING_GLSL

#include "renderer/shaders/random.glsl"

const uint HALF_MAX_BITS = 0x477fe000u;  // of 65504
// The exponent of 2^-14; smaller halves have the same spacing as from there on.
const uint LEAST_NORMAL_EXPONENT = 113u;

float round_by_chance(float value, uint bits)
{
    uint magnitude = floatBitsToUint(value) & 0x7fffffffu;
    if (magnitude >= HALF_MAX_BITS)
        return value;
    uint exponent = max(magnitude >> 23, LEAST_NORMAL_EXPONENT);
    float halves_per_unit = uintBitsToFloat((264u - exponent) << 23); // 2^10 of them in an octave
    float half_step = uintBitsToFloat((exponent - 10u) << 23);
    precise float halves = value * halves_per_unit;
    precise float below = floor(halves);
    precise float above_it = halves - below;
    return (uniform_from(uvec3(bits)).x < above_it ? below + 1.0 : below) * half_step;
}

#endif

// SPDX-License-Identifier: MIT
//
// Halves by whole numbers, the same bits on every device. What the driver's own conversions are
// worth is asked by halves.comp.
#ifndef NEPH_HALVES_GLSL
#define NEPH_HALVES_GLSL

#include "constants.h"

// Keep the upper bits, ties to even.
uint round_shift(uint bits, uint shift)
{
    return (bits + (1u << (shift - 1u)) - 1u + ((bits >> shift) & 1u)) >> shift;
}

// The nearest half. packHalf2x16 would leave the rounding to the driver.
uint to_half(float value)
{
    uint bits = floatBitsToUint(value);
    uint sign = (bits >> 16) & 0x8000u;
    uint magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u)
        return sign | 0x7e00u; // NaN
    if (magnitude >= 0x477ff000u)
        return sign | 0x7c00u; // from 65520 on
    if (magnitude >= 0x38800000u)
        return sign | round_shift(magnitude - 0x38000000u, 13u);
    if (magnitude >= 0x33000000u) // from 2^-25 on, below the normal halves
        return sign | round_shift((magnitude & 0x7fffffu) | 0x800000u, 126u - (magnitude >> 23));
    return sign;
}

float from_half(uint bits)
{
    uint sign = (bits & 0x8000u) << 16;
    uint exponent = (bits >> 10) & 31u;
    uint fraction = bits & 0x3ffu;
    if (exponent == 0u)
        return uintBitsToFloat(floatBitsToUint(float(fraction) * exp2(-24.0)) | sign);
    if (exponent == 31u)
        return uintBitsToFloat(sign | 0x7f800000u | (fraction << 13));
    return uintBitsToFloat(sign | ((exponent + 112u) << 23) | (fraction << 13));
}

#endif

// SPDX-License-Identifier: MIT
//
// Float32 arithmetic that survives fog: exponentials without cancellation or overflow, and sums
// whose error does not grow with the number of steps. GLSL has no expm1; phi() stands in for it.
#ifndef NEPH_NUMBERS_GLSL
#define NEPH_NUMBERS_GLSL

#include "constants.h"

const float PI = 3.14159265358979;

const float FAR_M = NEPH_GPU_FAR_M;

// Beyond e^-87 a float32 leaves the normal numbers, where drivers differ: call it 0.
const float EXPONENT_MIN = -87.0;

// (1 - e^-x) / x for x >= 0; 1 at 0. Every exponential integral of this project goes through it.
// Below 1 the subtraction would cancel (relative error 1.2e-7 / x), so the Taylor series is summed
// instead: its first neglected term is x^10 / 11! < 2.6e-8. Relative error below 3e-7 everywhere.
float phi(float x)
{
    if (x < 1.0)
        return 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 *
               (1.0 - x / 7.0 * (1.0 - x / 8.0 * (1.0 - x / 9.0 * (1.0 - x / 10.0))))))));
    return (1.0 - exp(max(-x, EXPONENT_MIN))) / x;
}

// e^-tau for an optical depth tau >= 0 of any size.
float transmittance(float optical_depth)
{
    return optical_depth < -EXPONENT_MIN ? exp(-optical_depth) : 0.0;
}

// 1 - e^-tau: the fraction that a stretch takes out of a beam, to full precision when it is thin.
float absorbed_fraction(float optical_depth)
{
    return optical_depth * phi(optical_depth);
}

vec3 transmittance(vec3 optical_depth)
{
    return vec3(transmittance(optical_depth.x), transmittance(optical_depth.y),
                transmittance(optical_depth.z));
}

vec3 absorbed_fraction(vec3 optical_depth)
{
    return vec3(absorbed_fraction(optical_depth.x), absorbed_fraction(optical_depth.y),
                absorbed_fraction(optical_depth.z));
}

// ln(1 + x) for x in [-0.3, 0.35], to full relative precision: 2 artanh(x / (2 + x)). Drivers may
// be off by 2^-21 absolute in log near 1.
float log_1_plus_small(float x)
{
    float s = x / (2.0 + x);
    float s2 = s * s;
    return 2.0 * s *
           (1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0)))));
}

float log_1_plus(float x)
{
    return x > -0.3 && x < 0.35 ? log_1_plus_small(x) : log(1.0 + x);
}

float least_positive(vec3 color)
{
    vec3 seen = mix(vec3(FAR_M), color, greaterThan(color, vec3(0.0)));
    return min(seen.r, min(seen.g, seen.b));
}

// A running sum that carries its own rounding error (Kahan 1965, CACM 8(1)): 4096 steps cost no
// more precision than one. `precise` keeps the compiler from proving the error to be zero.
struct Sum {
    vec4 value;
    vec4 excess; // what `value` has too much
};

Sum sum_zero()
{
    return Sum(vec4(0.0), vec4(0.0));
}

void sum_add(inout Sum sum, vec4 term)
{
    precise vec4 owed = term - sum.excess;
    precise vec4 total = sum.value + owed;
    precise vec4 excess = (total - sum.value) - owed;
    sum.value = total;
    sum.excess = excess;
}

#endif

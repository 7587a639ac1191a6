// SPDX-License-Identifier: MIT
//
// Float32 arithmetic for optical depths of any size: exponentials without cancellation or overflow,
// and compensated sums. GLSL has no expm1(); phi() takes its place.
#ifndef NEPH_NUMBERS_GLSL
#define NEPH_NUMBERS_GLSL

#include "constants.h"

const float PI = 3.14159265358979;

const float FAR_M = NEPH_GPU_FAR_M;

// Below e^-87 a float32 is denormal, where drivers differ; the result is set to 0 instead.
const float EXPONENT_MIN = -87.0;

// phi(x) = (1 - e^-x) / x for x >= 0, and 1 at 0. All exponential integrals of the project use it.
//
// Below 1 the subtraction would cancel (relative error 1.2e-7 / x), so the Taylor series is summed:
//
//   phi(x) = 1 - x/2! + x^2/3! - ... = 1 - x/2 (1 - x/3 (1 - x/4 (...)))
//
// The first neglected term is x^10 / 11! < 2.6e-8. The relative error is below 3e-7 for all x.
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

// 1 - e^-tau: the fraction of a beam that is absorbed or scattered, at full relative precision when
// the stretch is thin.
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

// ln(1 + x) for x in [-0.3, 0.35] at full relative precision, as 2 artanh(x / (2 + x)). A driver's
// log() may have an absolute error of 2^-21 near 1.
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

// The smallest channel that is > 0; FAR_M without any.
float least_positive(vec3 color)
{
    vec3 seen = mix(vec3(FAR_M), color, greaterThan(color, vec3(0.0)));
    return min(seen.r, min(seen.g, seen.b));
}

// A compensated sum (W. Kahan, "Further Remarks on Reducing Truncation Errors", CACM 8(1), 1965):
// 4096 terms lose no more precision than one. `precise` keeps the compiler from optimizing the
// error term to 0.
struct Sum {
    vec4 value;
    vec4 excess; // rounding error: `value` is too large by this
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

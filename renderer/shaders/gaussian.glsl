// SPDX-License-Identifier: MIT
//
// A Gaussian blob: extinction e^(-r^2 / 2 w^2).
#ifndef NEPH_GAUSSIAN_GLSL
#define NEPH_GAUSSIAN_GLSL

#include "numbers.glsl"

struct Gaussian {
    vec3 center_m;
    float width_m; // > 0
};

// Density at a point, 1 at the centre.
float gaussian_density(Gaussian blob, vec3 point_m)
{
    vec3 r = (point_m - blob.center_m) / blob.width_m;
    return exp(max(-0.5 * dot(r, r), EXPONENT_MIN));
}

// erfc(x) for x >= 0: relative error 1.2e-7 before rounding (W. H. Press et al., Numerical Recipes
// in C, 2nd edition, section 6.2).
float erfc_positive(float x)
{
    float t = 1.0 / (1.0 + 0.5 * x);
    float series = 1.00002368 + t * (0.37409196 + t * (0.09678418 + t * (-0.18628806 + t *
                   (0.27886807 + t * (-1.13520398 + t * (1.48851587 + t * (-0.82215223 + t *
                   0.17087277)))))));
    return t * exp(max(-x * x - 1.26551223 + t * series, EXPONENT_MIN));
}

// erf(b) - erf(a) for a <= b. Over less than 1 by four-point Gauss-Legendre (relative error below
// 1e-7 there), because the difference of two error functions would cancel; else from erfc on the
// side away from 0, where it keeps its digits.
float erf_between(float a, float b)
{
    float half_length = 0.5 * (b - a), middle = 0.5 * (a + b);
    if (half_length < 0.5) {
        float x = 0.339981043584856 * half_length, y = 0.861136311594053 * half_length;
        float sum = 0.652145154862546 * (exp(max(-(middle - x) * (middle - x), EXPONENT_MIN)) +
                                         exp(max(-(middle + x) * (middle + x), EXPONENT_MIN))) +
                    0.347854845137454 * (exp(max(-(middle - y) * (middle - y), EXPONENT_MIN)) +
                                         exp(max(-(middle + y) * (middle + y), EXPONENT_MIN)));
        return 1.12837916709551 * half_length * sum; // 2 / sqrt(pi)
    }
    if (a >= 0.0)
        return erfc_positive(a) - erfc_positive(b);
    if (b <= 0.0)
        return erfc_positive(-b) - erfc_positive(-a);
    return 2.0 - erfc_positive(b) - erfc_positive(-a);
}

// The integral of the density over t in [t0, t1] [m].
float gaussian_integral_m(Gaussian blob, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    vec3 to_center_m = blob.center_m - origin_m;
    float nearest_m = dot(to_center_m, direction);
    vec3 impact = (to_center_m - nearest_m * direction) / blob.width_m;
    float across = exp(max(-0.5 * dot(impact, impact), EXPONENT_MIN));
    float per_m = 0.707106781186548 / blob.width_m;
    return across * blob.width_m * 1.25331413731550 * // sqrt(pi / 2)
           erf_between((t0_m - nearest_m) * per_m, (t1_m - nearest_m) * per_m);
}

#endif

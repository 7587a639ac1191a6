// SPDX-License-Identifier: MIT
//
// A Gaussian blob of extinction e^(-r^2 / 2 w^2), and its exact integral along a ray.
//
// For a ray with the impact parameter p, let x be the distance from the ray's nearest point to the
// centre, over w sqrt(2). The density along the ray is e^(-p^2 / 2 w^2) e^(-x^2), so its integral
// is a difference of error functions, which GLSL does not have.
#ifndef NEPH_GAUSSIAN_GLSL
#define NEPH_GAUSSIAN_GLSL

#include "solids.glsl"
#include "stretch.glsl"

struct Gaussian {
    vec3 center_m; // relative to the camera
    float width_m;
    float reach_m; // a ray outside this radius meets less than 1e-7 of optical depth
};

float gaussian_density(Gaussian blob, vec3 point_m)
{
    vec3 r = (point_m - blob.center_m) / blob.width_m;
    return transmittance(0.5 * dot(r, r));
}

// The scaled complementary error function e^(x^2) erfc(x) for 0 <= x <= 10: a Chebyshev
// interpolation of (1 + 2x) erfcx(x) in x / (x + 2). Relative error 2.6e-8, in float32 below 3e-7.
// The variable is from J. L. Schonfelder, Math. Comp. 32, 1978.
float erfcx(float x)
{
    float y = 2.4 * (x / (x + 2.0)) - 1.0;
    float p = -8.21977873e-05;
    p = p * y - 0.000146037773;
    p = p * y + 0.000722587149;
    p = p * y + 0.00210881873;
    p = p * y - 0.00629502451;
    p = p * y - 0.021297918;
    p = p * y + 0.114120718;
    p = p * y - 0.178211399;
    p = p * y - 0.0189856797;
    p = p * y + 1.28702695;
    return p / (1.0 + 2.0 * x);
}

// The integral of e^(a^2 - x^2) over [a, a + h], a >= 0, h >= 0. While the density falls by less
// than a factor e, the difference of two erfc would cancel; five-point Gauss-Legendre is accurate
// to 1e-8 there. Beyond it, the cancellation costs at most a factor of 2 in relative error.
float gaussian_leg(float a, float h)
{
    float fall = h * (2.0 * a + h); // b^2 - a^2 with b = a + h, without cancellation
    if (fall > 1.0)
        return 0.886226925 * (erfcx(a) - transmittance(fall) * erfcx(min(a + h, 10.0)));
    vec4 x = h * vec4(0.046910077, 0.230765345, 0.769234655, 0.953089923);
    vec4 density = exp(-x * (2.0 * a + x));
    float middle = exp(-0.5 * h * (2.0 * a + 0.5 * h));
    return h * (dot(density, vec4(0.118463443, 0.239314335, 0.239314335, 0.118463443)) +
                0.284444444 * middle);
}

// Integral of the density along origin + t direction over [t0, t1] [m].
//
//          impact parameter
//                |
//    ---[========+==================]---> ray
//       a        0                  b       x = (t - nearest) / scale
//
// The two halves of [a, b] on both sides of the nearest point are integrated outwards from it.
float gaussian_integral_m(Gaussian blob, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    const float FAR = 10.0; // e^-100 is 0
    float scale_m = 1.41421356 * blob.width_m;
    vec3 offset_m = origin_m - blob.center_m;
    float nearest_m = -dot(offset_m, direction);
    vec3 impact = (offset_m + nearest_m * direction) / scale_m;
    float a = clamp((t0_m - nearest_m) / scale_m, -FAR, FAR);
    float b = clamp((t1_m - nearest_m) / scale_m, -FAR, FAR);
    // The half beyond the nearest point, or the whole when [a, b] lies on one side.
    float h = clamp((t1_m - t0_m) / scale_m, 0.0, 2.0 * FAR); // keeps the digits that b - a loses
    bool before = b <= 0.0, beyond = a >= 0.0;
    float near_a = before ? -b : max(a, 0.0);
    float near_h = before || beyond ? h : b;
    float sum = transmittance(dot(impact, impact) + near_a * near_a) * gaussian_leg(near_a, near_h);
    if (!before && !beyond)
        sum += transmittance(dot(impact, impact)) * gaussian_leg(0.0, -a);
    return scale_m * sum;
}

// Clips `inside` to the sphere of radius reach_m.
void gaussian_narrow(Gaussian blob, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    float near_m, far_m;
    bool met = sphere_interval(blob.center_m, blob.reach_m, origin_m, direction, near_m, far_m);
    inside.t0_m = max(inside.t0_m, near_m);
    inside.t1_m = met ? min(inside.t1_m, far_m) : inside.t0_m;
}

#endif

// SPDX-License-Identifier: MIT
//
// Directions and distances drawn from their distributions, in float32 without cancellation.
#ifndef NEPH_SAMPLING_GLSL
#define NEPH_SAMPLING_GLSL

#include "phase.glsl"
#include "random.glsl"

// The direction at a polar angle about an axis, 1 - cos given because it keeps its digits near the
// axis. Frame: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
vec3 direction_about(vec3 axis, float versine, float azimuth)
{
    float side = axis.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + axis.z);
    float b = axis.x * axis.y * a;
    vec3 first = vec3(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    vec3 second = vec3(b, side + axis.y * axis.y * a, -axis.y);
    float sine = sqrt(max(0.0, versine * (2.0 - versine)));
    return normalize(axis + (sine * cos(azimuth) * first + sine * sin(azimuth) * second) -
                     versine * axis);
}

// 1 - cos of the scattering angle about the forward direction for g >= 0. From the inverse of the
// cumulative distribution, cos = (1 + g^2 - s^2) / 2g with s = (1 - g^2) / (1 - g + 2 g u), as a
// product, for any g in [0, 1): g = 0 is isotropic.
float henyey_greenstein_versine(float g, float u)
{
    float low = 1.0 - g;
    float divisor = low + 2.0 * g * u;
    float s = low * (1.0 + g) / divisor;
    return low * (1.0 - u) * (s + low) / divisor;
}

// cos = a - 1/a, a^3 = z + sqrt(z^2 + 1), z = 2 (2 u - 1) (J. R. Frisvad, JOSA A 28(12), 2011).
float rayleigh_versine(float u)
{
    float z = 2.0 * (2.0 * u - 1.0);
    float a = pow(abs(z) + sqrt(z * z + 1.0), 1.0 / 3.0);
    float cosine = a - 1.0 / a;
    return clamp(z >= 0.0 ? 1.0 - cosine : 1.0 + cosine, 0.0, 2.0);
}

// The direction of travel after scattering; u.x decides the angle.
vec3 sample_phase(uint kind, float g, vec3 direction, vec2 u)
{
    float asymmetry = kind == PHASE_HENYEY_GREENSTEIN ? g : 0.0;
    float versine = kind == PHASE_RAYLEIGH ? rayleigh_versine(u.x)
                                           : henyey_greenstein_versine(abs(asymmetry), u.x);
    return direction_about(asymmetry < 0.0 ? -direction : direction, versine, 2.0 * PI * u.y);
}

// About a normal, with density cos / pi.
vec3 sample_cosine(vec3 normal, vec2 u)
{
    float cosine = sqrt(u.x);
    return direction_about(normal, (1.0 - u.x) / (1.0 + cosine), 2.0 * PI * u.y);
}

#endif

// SPDX-License-Identifier: MIT
//
// Sampling of directions from phase functions and cosine lobes, in float32 without cancellation.
#ifndef NEPH_SAMPLING_GLSL
#define NEPH_SAMPLING_GLSL

#include "phase.glsl"
#include "random.glsl"

// The direction at a polar angle and an azimuth about a unit axis. The angle is given as its
// versine, 1 - cos, which keeps the digits of small angles. The orthonormal frame is from T. Duff
// et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
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

// The direction of travel after scattering, distributed as the phase function; u.x gives the angle.
vec3 sample_phase(uint kind, float g, vec3 direction, vec2 u)
{
    return direction_about(g < 0.0 ? -direction : direction, phase_versine(kind, abs(g), u.x),
                           2.0 * PI * u.y);
}

// A direction about a normal, with density cos / pi.
vec3 sample_cosine(vec3 normal, vec2 u)
{
    float cosine = sqrt(u.x);
    return direction_about(normal, (1.0 - u.x) / (1.0 + cosine), 2.0 * PI * u.y);
}

#endif

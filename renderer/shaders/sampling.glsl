// SPDX-License-Identifier: MIT
//
// Directions and distances drawn from their distributions, in float32 without cancellation.
#ifndef NEPH_SAMPLING_GLSL
#define NEPH_SAMPLING_GLSL

#include "fog.glsl"
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

// The distance within which a ray from height y meets exactly `optical_depth` of a layer; FAR_M
// when it never does: -ln(1 - z) / r, with r = falloff k_y and z = r optical_depth / extinction.
// In logarithms where extinction leaves float32.
float fog_free_path(FogLayer layer, float y_m, float k_y, float optical_depth)
{
    float rate_per_m = layer.falloff_per_m * k_y;
    float exponent = -layer.falloff_per_m * (y_m - layer.height_m);
    if (exponent < -60.0) {
        if (rate_per_m >= 0.0)
            return FAR_M;
        float log_z = log(-rate_per_m) + log(optical_depth / layer.extinction_per_m) - exponent;
        float length_m = log_z > 15.0 ? log_z : log(1.0 + exp(max(log_z, EXPONENT_MIN)));
        return min(length_m / -rate_per_m, FAR_M);
    }
    float straight_m = optical_depth / fog_extinction_per_m(layer, y_m);
    float z = rate_per_m * straight_m;
    if (z >= 1.0)
        return FAR_M;
    return abs(z) < 1e-6 ? min(straight_m, FAR_M)
                         : min(-log_1_plus(-z) / rate_per_m, FAR_M);
}

#endif

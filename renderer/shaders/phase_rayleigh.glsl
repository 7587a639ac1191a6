// SPDX-License-Identifier: MIT
//
// The Rayleigh phase function: float32 version of scenes/phase_rayleigh.c.

float rayleigh_per_sr(vec3 view, vec3 sun)
{
    float cosine = dot(view, sun);
    return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
}

// Sampling: 1 - cos with the closed inverse of the cumulative distribution (J. R. Frisvad,
// "Importance sampling the Rayleigh phase function", JOSA A 28(12), 2011):
//
//   cos = a - 1/a,    a^3 = z + sqrt(z^2 + 1),    z = 2 (2 u - 1)
float rayleigh_versine(float u)
{
    float z = 2.0 * (2.0 * u - 1.0);
    float a = pow(abs(z) + sqrt(z * z + 1.0), 1.0 / 3.0);
    float cosine = a - 1.0 / a;
    return clamp(z >= 0.0 ? 1.0 - cosine : 1.0 + cosine, 0.0, 2.0);
}

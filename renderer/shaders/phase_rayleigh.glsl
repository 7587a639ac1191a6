// SPDX-License-Identifier: MIT
//
// scenes/phase_rayleigh.c in float32.

float rayleigh_per_sr(vec3 view, vec3 sun)
{
    float cosine = dot(view, sun);
    return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
}

// cos = a - 1/a, a^3 = z + sqrt(z^2 + 1), z = 2 (2 u - 1) (J. R. Frisvad, JOSA A 28(12), 2011).
float rayleigh_versine(float u)
{
    float z = 2.0 * (2.0 * u - 1.0);
    float a = pow(abs(z) + sqrt(z * z + 1.0), 1.0 / 3.0);
    float cosine = a - 1.0 / a;
    return clamp(z >= 0.0 ? 1.0 - cosine : 1.0 + cosine, 0.0, 2.0);
}

// SPDX-License-Identifier: MIT
//
// Phase functions [1/sr], normalised over the sphere.
#ifndef NEPH_PHASE_GLSL
#define NEPH_PHASE_GLSL

#include "numbers.glsl"

// enum neph_phase_kind
const uint PHASE_ISOTROPIC = 0;
const uint PHASE_HENYEY_GREENSTEIN = 1;
const uint PHASE_RAYLEIGH = 2;

// Henyey & Greenstein 1941 with 1 + g^2 - 2 g cos = (1 - |g|)^2 + 2 |g| (1 - |cos|) near the peak.
// 1 - a.b = |a - b|^2 / 2 for unit vectors: the dot product of float32 vectors is only good to
// 6e-8, which at g = 0.99 would be 0.2 % of the peak; the difference keeps all its digits.
float henyey_greenstein_per_sr(float g, vec3 view, vec3 sun)
{
    vec3 off_peak = g >= 0.0 ? view - sun : view + sun;
    float a = abs(g);
    float base = (1.0 - a) * (1.0 - a) + a * dot(off_peak, off_peak);
    return (1.0 - a) * (1.0 + a) / (4.0 * PI * base * sqrt(base));
}

// Sunlight travels along -sun before the event and along -view, to the camera, after it: the
// scattering angle is the one between `view` and `sun` (both unit).
float phase_per_sr(uint kind, float g, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_per_sr(g, view, sun);
    if (kind == PHASE_RAYLEIGH) {
        float cosine = dot(view, sun);
        return 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
    }
    return 1.0 / (4.0 * PI);
}

#endif

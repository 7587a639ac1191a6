// SPDX-License-Identifier: MIT
//
// Phase functions [1/sr], normalized over the sphere: values and sampling. Each kind has its own
// file; only this file tells kinds apart. A new kind needs a file and a line in each function
// below. The CPU version is scenes/phase_NAME.c.
#ifndef NEPH_PHASE_GLSL
#define NEPH_PHASE_GLSL

#include "numbers.glsl"
#include "phase_henyey_greenstein.glsl"
#include "phase_isotropic.glsl"
#include "phase_rayleigh.glsl"
#include "scenes/phase_kinds.h"

// PHASE_ISOTROPIC, ...: enum neph_phase_kind.
#define PHASE_NUMBER(number, NAME, name) const uint PHASE_##NAME = number;
NEPH_PHASE_KINDS(PHASE_NUMBER)

#define PHASE_ONE(number, NAME, name) +1
#if NEPH_PHASE_KINDS(PHASE_ONE) != 3
#error A new kind: give each function below its line.
#endif

// Value for single scattering of sunlight. Light travels along -sun before the event and along
// -view, to the camera, after it, so the scattering angle is the angle between `view` and `sun`
// (both unit).
float phase_per_sr(uint kind, float g, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_per_sr(g, view, sun);
    if (kind == PHASE_RAYLEIGH)
        return rayleigh_per_sr(view, sun);
    return ISOTROPIC_PER_SR;
}

// The phase function with reduced anisotropy, for octaves. `whole_per_sr` is the unreduced value.
// For Henyey-Greenstein g is scaled, as in the octave model's papers; for other kinds the
// difference to isotropic is.
float phase_cut_per_sr(uint kind, float g, float part, float whole_per_sr, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_per_sr(part * g, view, sun);
    return mix(ISOTROPIC_PER_SR, whole_per_sr, part);
}

// Sampling: 1 - cos of the scattering angle for a uniform number u and g >= 0. The versine keeps
// the digits of small angles, which the cosine loses.
float phase_versine(uint kind, float g, float u)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_versine(g, u);
    if (kind == PHASE_RAYLEIGH)
        return rayleigh_versine(u);
    return isotropic_versine(u);
}

// The mean cosine (asymmetry parameter).
float phase_mean_cosine(uint kind, float g) { return kind == PHASE_HENYEY_GREENSTEIN ? g : 0.0; }

#endif

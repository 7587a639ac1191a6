// SPDX-License-Identifier: MIT
//
// Phase functions [1/sr], normalised over the sphere. Each kind lies in its own file, and only here
// kinds are told apart: a new one is a file and a line in each of these functions. The kind's other
// half is scenes/phase_NAME.c.
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

// Sunlight travels along -sun before the event and along -view, to the camera, after it: the
// scattering angle is the one between `view` and `sun` (both unit).
float phase_per_sr(uint kind, float g, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_per_sr(g, view, sun);
    if (kind == PHASE_RAYLEIGH)
        return rayleigh_per_sr(view, sun);
    return ISOTROPIC_PER_SR;
}

// The phase function with its excess over isotropic cut to a part; `whole_per_sr` is the uncut one.
// For Henyey-Greenstein the mean cosine is cut, as the authors of octaves have it.
float phase_cut_per_sr(uint kind, float g, float part, float whole_per_sr, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_per_sr(part * g, view, sun);
    return mix(ISOTROPIC_PER_SR, whole_per_sr, part);
}

// 1 - cos of the scattering angle about the forward direction for a uniform number u and g >= 0.
float phase_versine(uint kind, float g, float u)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_versine(g, u);
    if (kind == PHASE_RAYLEIGH)
        return rayleigh_versine(u);
    return isotropic_versine(u);
}

float phase_mean_cosine(uint kind, float g) { return kind == PHASE_HENYEY_GREENSTEIN ? g : 0.0; }

#endif

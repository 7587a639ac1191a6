// SPDX-License-Identifier: MIT
//
// Phase functions [1/sr], normalized over the sphere: values and sampling. The kinds of
// NEPH_PHASES_IN_SHADERS each have a file, and only this file tells them apart; all others are
// tables (phase_table.glsl), which kernels with media.glsl have. The CPU version is
// scenes/phase_NAME.c.
#ifndef NEPH_PHASE_GLSL
#define NEPH_PHASE_GLSL

#include "numbers.glsl"
#include "phase_henyey_greenstein.glsl"
#include "phase_isotropic.glsl"
#include "phase_rayleigh.glsl"
#include "scenes/phase_kinds.h"

// PHASE_ISOTROPIC, ...: enum neph_phase_kind.
#define PHASE_NUMBER(number, NAME, name) const uint PHASE_##NAME = number;
NEPH_PHASES_IN_SHADERS(PHASE_NUMBER)

#define PHASE_ONE(number, NAME, name) +1
#if NEPH_PHASES_IN_SHADERS(PHASE_ONE) != 3
#error A new kind: give each function below its line.
#endif
const uint PHASE_TABLE = NEPH_PHASES_IN_SHADERS(PHASE_ONE);

#ifdef NEPH_MEDIA_GLSL
#include "phase_table.glsl"
// Whether a medium's is a table. A macro, so that its condition is constant before anything is
// inlined.
#define is_phase_table(kind) (HAS_PHASE_TABLES && (kind) == PHASE_TABLE)
// Whether its channels may differ.
#define is_phase_coloured(kind) (PHASES_COLOURED && (kind) == PHASE_TABLE)
#else
#define is_phase_table(kind) false
#define is_phase_coloured(kind) false
float phase_channel_table(float table, uint channel) { return table; }
float phase_table_per_sr(float table, vec3 view, vec3 sun) { return 0.0; }
float phase_table_versine(float table, float u) { return 0.0; }
float phase_table_mean_cosine(float table) { return 0.0; }
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
    if (is_phase_table(kind))
        return phase_table_per_sr(g, view, sun);
    return ISOTROPIC_PER_SR;
}

// The g of one channel; the medium's own g has the mean of the channels.
float phase_channel_g(uint kind, float g, uint channel)
{
    return is_phase_coloured(kind) ? phase_channel_table(g, channel) : g;
}

// The values by channel.
vec3 phase_rgb_per_sr(uint kind, float g, vec3 view, vec3 sun)
{
    if (!is_phase_coloured(kind))
        return vec3(phase_per_sr(kind, g, view, sun));
    return vec3(phase_table_per_sr(phase_channel_table(g, 0), view, sun),
                phase_table_per_sr(phase_channel_table(g, 1), view, sun),
                phase_table_per_sr(phase_channel_table(g, 2), view, sun));
}

// The phase function with reduced anisotropy, for octaves. `whole_per_sr` is the unreduced value.
// For Henyey-Greenstein g is scaled, as in the octave model's papers; a table becomes the
// Henyey-Greenstein of its scaled mean cosine, that of all channels, because a diffraction peak
// does not survive a second scattering; for other kinds the difference to isotropic is scaled.
vec3 phase_cut_per_sr(uint kind, float g, float part, vec3 whole_per_sr, vec3 view, vec3 sun)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return vec3(henyey_greenstein_per_sr(part * g, view, sun));
    if (is_phase_table(kind) && part < 1.0)
        return vec3(henyey_greenstein_per_sr(part * phase_table_mean_cosine(g), view, sun));
    return mix(vec3(ISOTROPIC_PER_SR), whole_per_sr, part);
}

// Sampling: 1 - cos of the scattering angle for a uniform number u and g >= 0. The versine keeps
// the digits of small angles, which the cosine loses.
float phase_versine(uint kind, float g, float u)
{
    if (kind == PHASE_HENYEY_GREENSTEIN)
        return henyey_greenstein_versine(g, u);
    if (kind == PHASE_RAYLEIGH)
        return rayleigh_versine(u);
    if (is_phase_table(kind))
        return phase_table_versine(g, u);
    return isotropic_versine(u);
}

// The mean cosine (asymmetry parameter).
float phase_mean_cosine(uint kind, float g)
{
    if (is_phase_table(kind))
        return phase_table_mean_cosine(g);
    return kind == PHASE_HENYEY_GREENSTEIN ? g : 0.0;
}

#endif

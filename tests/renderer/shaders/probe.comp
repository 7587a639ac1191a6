#version 450
// SPDX-License-Identifier: MIT
//
// Probe of the included functions, value by value, for tests/renderer/test_shaders.c: one thread is
// one call.
#extension GL_GOOGLE_include_directive : require

#include "fog.glsl"
#include "phase.glsl"
#include "solids.glsl"

layout(local_size_x = 64) in;

const uint PROBE_PHI = 0;            // a.x -> phi
const uint PROBE_TRANSMITTANCE = 1;  // a.x -> e^-a.x
const uint PROBE_ABSORBED = 2;       // a.x -> 1 - e^-a.x
const uint PROBE_PHASE = 3;          // kind, a = (g, u), b = view, c = sun -> 1/sr, versine, cosine
const uint PROBE_EXTINCTION = 4;     // a = layer, b.x = y -> 1/m
const uint PROBE_FOG = 5;            // a = layer, b = (y, k_y, length) -> depth, transmittance
const uint PROBE_DISTANCE = 6;       // a = layer, b = (y, k_y, optical depth) -> distance, thin end
const uint PROBE_SOLID = 7;          // kind, a = low or centre, b = high, radius, c = origin,
                                     // d = direction -> t0, t1, 1 if met
const uint PROBE_SUM = 8;            // a.x added b.x times -> sum
const uint PROBE_LOOPS = 9;          // a = (outer, inner) iterations -> iterations made: all inner
                                     // ones, outer ones
const uint PROBE_HALVES = 10;        // kind: two halves -> as converted by the driver, and the
                                     // halves that it makes of a.xy, as integers

struct Probe {
    vec4 a, b, c, d;
    uint what;
    uint kind;
    uvec2 padding;
};

layout(std430, binding = 0) readonly buffer Probes {
    Probe probes[];
};

layout(std430, binding = 1) writeonly buffer Answers {
    vec4 answers[];
};

vec4 answer(Probe p)
{
    FogLayer layer = FogLayer(p.a.x, p.a.y, p.a.z, p.a.w);
    switch (p.what) {
    case PROBE_PHI:
        return vec4(phi(p.a.x));
    case PROBE_TRANSMITTANCE:
        return vec4(transmittance(p.a.x));
    case PROBE_ABSORBED:
        return vec4(absorbed_fraction(p.a.x));
    case PROBE_PHASE:
        return vec4(phase_per_sr(p.kind, p.a.x, p.b.xyz, p.c.xyz),
                    phase_versine(p.kind, abs(p.a.x), p.a.y),
                    phase_mean_cosine(p.kind, p.a.x), 0.0);
    case PROBE_EXTINCTION:
        return vec4(fog_extinction_per_m(layer, p.b.x));
    case PROBE_FOG: {
        float optical_depth = fog_optical_depth(layer, p.b.x, p.b.y, p.b.z);
        return vec4(optical_depth, transmittance(optical_depth), 0.0, 0.0);
    }
    case PROBE_DISTANCE:
        return vec4(fog_distance_to(layer, p.b.x, p.b.y, p.b.z),
                    fog_distance_to_thin_end(layer, p.b.x, p.b.y, THIN), 0.0, 0.0);
    case PROBE_SOLID: {
        Solid solid = Solid(p.a.xyz, p.kind, p.b.xyz, p.b.w, vec4(0.0, 0.0, 0.0, p.a.w));
        float t0, t1;
        bool met = solid_interval(solid, p.c.xyz, p.d.xyz, t0, t1);
        return vec4(t0, t1, met ? 1.0 : 0.0, 0.0);
    }
    case PROBE_SUM: {
        Sum sum = sum_zero();
        for (uint i = 0; i < uint(p.b.x); i++)
            sum_add(sum, p.a.xxxx);
        return sum.value;
    }
    case PROBE_LOOPS: {
        uint inner_turns = 0, outer_turns = 0;
        for (uint i = 0; i < uint(p.a.x); i++) {
            outer_turns++;
            for (uint j = 0; j < uint(p.a.y); j++)
                inner_turns += (i ^ j) == 0xffffffffu ? 2u : 1u;
        }
        return vec4(inner_turns, outer_turns, 0.0, 0.0);
    }
    case PROBE_HALVES: {
        uint word = packHalf2x16(p.a.xy);
        return vec4(unpackHalf2x16(p.kind), float(word & 0xffffu), float(word >> 16));
    }
    }
    return vec4(-1.0);
}

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < probes.length())
        answers[i] = answer(probes[i]);
}

#version 450
// SPDX-License-Identifier: MIT
//
// Fills the sun cache (sun_cache.glsl): one thread per node traces one sun ray, as the ray marcher
// does. Solids are left out: the lookup tests separately whether a solid blocks the sun.
#extension GL_GOOGLE_include_directive : require

#define SEES_GRID_TEXELS

#include "march_light.glsl"
#include "march_run.glsl"
#include "counting.glsl"

layout(std430, binding = 5) writeonly buffer SunNodes {
    float sun_nodes[];
};

layout(std430, binding = 6) buffer SunCounters {
    uint density_evaluations[2]; // lower and upper half of 64 bits
    uint closed_forms[2];
} counters;

vec3 node_m(uint node)
{
    uvec3 size = frame.sun_lattice.size;
    uvec3 place = uvec3(node % size.x, node / size.x % size.y, node / (size.x * size.y));
    return frame.sun_lattice.origin_m + vec3(place) / frame.sun_lattice.per_m;
}

void main()
{
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    uint node = run.first_ray + gl_GlobalInvocationID.x;
    vec3 depth = sun_optical_depth_by_kind(SHAPE_KINDS, node_m(node));
    for (uint c = 0; c < SUN_CHANNELS; c++)
        sun_nodes[SUN_CHANNELS * node + c] = depth[c];
    ADD_64(counters.density_evaluations, density_evaluations);
    ADD_64(counters.closed_forms, closed_forms);
}

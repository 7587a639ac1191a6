#version 450
// SPDX-License-Identifier: MIT
//
// The path tracer's kernel before all others, if SUN_BY_TABLE: fills the table of transmittance to
// the sun (tracer_sun.glsl) from densities at a few places. One thread per node. The table need not
// be exact, because tracer_check.comp corrects it.
#extension GL_GOOGLE_include_directive : require

#include "tracer_sun.glsl"

layout(local_size_x = 64) in;

// Densities per medium on a node's sun ray.
const uint PLACES = 24;

float shape_depth(uint m, vec3 point_m)
{
    float t0_m = 0.0, t1_m = FAR_M, sum = 0.0;
    if (!clip_medium(m, point_m, to_sun(), t0_m, t1_m))
        return 0.0;
    float step_m = (t1_m - t0_m) / float(PLACES);
    for (uint i = 0; i < PLACES; i++)
        sum += medium_extinction_per_m(m, point_m + (t0_m + (float(i) + 0.5) * step_m) * to_sun());
    return step_m * sum * frame.media[m].extinction_color.r;
}

void main()
{
    uint node = gl_GlobalInvocationID.x;
    uvec3 size = frame.sun_lattice.size;
    if (node >= size.x * size.y * size.z)
        return;
    uvec3 place = uvec3(node % size.x, node / size.x % size.y, node / (size.x * size.y));
    vec3 point_m = frame.sun_lattice.origin_m + vec3(place) / frame.sun_lattice.per_m;
    float depth = 0.0;
    for (uint m = 0; m < media_count(); m++)
        if (!is_fog(m))
            depth += shape_depth(m, point_m);
    sun_transmittances[node] = max(transmittance(depth), SUN_LEAST);
}

#version 450
// SPDX-License-Identifier: MIT
//
// How much of the sun the air before the camera sees past media and solids: a thread is a froxel of
// sky_aerial.glsl, from its slice before to its own, at some places in between. The planet's own
// shadow is in the table of transmittance to the sun.
#extension GL_GOOGLE_include_directive : require

#define SKY_IS_FILLED
#include "march_light.glsl"
#include "march_run.glsl"
#include "counting.glsl"

layout(std430, binding = 6) buffer SunCounters {
    uint density_evaluations[2]; // lower and upper half
    uint closed_forms[2];
} counters;

const uint GROUND = 0; // of the solids

vec3 sunlit_at(vec3 point_m)
{
    is_in_shape = false; // a map is good enough
    return sees_sun(point_m, GROUND) ? fraction_through(mapped_or_own_sun_depth(point_m))
                                     : vec3(0.0);
}

void main()
{
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    uint index = run.first_ray + gl_GlobalInvocationID.x;
    uint columns = eye.aerial_columns, rows = eye.aerial_rows;
    uint column = index % columns, row = index / columns % rows;
    uint slice = 1u + index / (columns * rows);
    float near_m = sky_slice_m(slice - 1u), far_m = sky_slice_m(slice);
    vec3 direction = sky_aerial_direction(column, row), sum = vec3(0.0);
    for (uint k = 0u; k < NEPH_GPU_SKY_SUN_SAMPLES; k++) {
        float part = (float(k) + 0.5) / float(NEPH_GPU_SKY_SUN_SAMPLES);
        sum += sunlit_at(mix(near_m, far_m, part) * direction);
    }
    sky_nodes[sky_aerial_node(column, row, slice) + VEIL_SHADE] =
        vec4(sum / float(NEPH_GPU_SKY_SUN_SAMPLES), 0.0);
    ADD_64(counters.density_evaluations, density_evaluations);
    ADD_64(counters.closed_forms, closed_forms);
}

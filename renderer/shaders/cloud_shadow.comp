#version 450
// SPDX-License-Identifier: MIT
//
// Fills the shadow map of clouds (layout and lookup: cloud_shadow.glsl). One thread computes one
// texel of one level: it starts behind all shapes, finds where the clouds on this sun ray begin and
// end, and stores the optical depth towards the sun at `layers` places between these ends. A place
// has the same depth that a ray marcher would compute there.
//
// Solids are left out of the map: the lookup tests separately whether a solid blocks the sun.
#extension GL_GOOGLE_include_directive : require

#define SEES_GRID_TEXELS

#include "march_light.glsl"
#include "march_run.glsl"
#include "counting.glsl"

layout(std430, binding = 5) writeonly buffer ShadowNumbers {
    float shadow_numbers[];
};

layout(std430, binding = 6) buffer SunCounters {
    uint density_evaluations[2]; // lower and upper half of 64 bits
    uint closed_forms[2];
} counters;

// Start of a texel's sun ray: on the far side of all shapes, seen from the sun.
vec3 start_m(uint level, uvec2 texel)
{
    vec2 place_m = frame.shadow.levels[level].low_m +
                   vec2(texel) / frame.shadow.levels[level].per_m;
    return frame.shadow.plane_m + place_m.x * frame.shadow.side_u +
           place_m.y * frame.shadow.side_v + frame.shadow.start_m * to_sun();
}

// The part of a sun ray that has shapes on it. NEPH_GPU_SHADOW_SAMPLES equal steps sample the
// extinction at their middles; the part reaches from the middle of the step before the first
// non-empty one to the middle of the step after the last:
//
//   samples   .   .   x   x   .   x   .   .      x: extinction > 0
//   result        |-------------------|
//
// When no sample finds extinction, the whole hull is returned: a cloud may be thinner than a step.
Stretch shapes_on(vec3 origin_m)
{
    Stretch hull = scene_stretch(SHAPE_KINDS, origin_m, to_sun(), FAR_M);
    if (hull.t1_m <= hull.t0_m)
        return Stretch(0.0, 0.0);
    Steps steps = equal_steps(hull, NEPH_GPU_SHADOW_SAMPLES);
    Stretch found = Stretch(hull.t1_m, hull.t0_m);
    for (uint i = 0; i < NEPH_GPU_SHADOW_SAMPLES; i++) {
        vec3 middle_m = origin_m + step_point_m(steps, i, 0.5) * to_sun();
        if (SKIPS && shapes_are_empty(middle_m))
            continue;
        density_evaluations++;
        if (sampled_extinctions_per_m(SHAPE_KINDS, middle_m) == vec3(0.0))
            continue;
        found.t0_m = min(found.t0_m, step_point_m(steps, i, -0.5));
        found.t1_m = max(found.t1_m, step_point_m(steps, i, 1.5));
    }
    return found.t0_m < found.t1_m
               ? Stretch(max(found.t0_m, hull.t0_m), min(found.t1_m, hull.t1_m))
               : hull;
}

void main()
{
    if (gl_GlobalInvocationID.x >= run.ray_count)
        return;
    uint entry = run.first_ray + gl_GlobalInvocationID.x, side = frame.shadow.texels;
    uint level = entry / (side * side);
    uvec2 texel = uvec2(entry % side, entry / side % side);
    vec3 origin_m = start_m(level, texel);
    Stretch shapes = shapes_on(origin_m);
    uint at = shadow_texel(level, texel);
    shadow_numbers[at] = frame.shadow.start_m + shapes.t0_m;
    shadow_numbers[at + 1u] = frame.shadow.start_m + shapes.t1_m;
    uint layers = make_nonuniform(frame.shadow.layers);
    for (uint layer = 0; layer < layers; layer++) {
        float t_m = layer > 0u ? mix(shapes.t0_m, shapes.t1_m, float(layer) / float(layers)) : 0.0;
        vec3 depth = sun_optical_depth_by_kind(SHAPE_KINDS, origin_m + t_m * to_sun());
        for (uint c = 0; c < SUN_CHANNELS; c++)
            shadow_numbers[at + SHADOW_ENDS + SUN_CHANNELS * layer + c] = depth[c];
    }
    ADD_64(counters.density_evaluations, density_evaluations);
    ADD_64(counters.closed_forms, closed_forms);
}

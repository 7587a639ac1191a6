// SPDX-License-Identifier: MIT
//
// The shadow map of clouds: what of the sunlight has come through all shapes. A texel is a sun ray:
// how far along it shapes begin and end, and between these the optical depth towards the sun from
// some places at equal distances, of which the farthest from the sun has all of it
// (cloud_shadow.comp writes them). With one place this is the beer shadow map of S. Hillaire,
// "Physically Based Sky, Atmosphere and Cloud Rendering in Frostbite" (SIGGRAPH 2016).
//
// Transmittance is what is interpolated between texels, not optical depth: light on the ground then
// keeps its mean, and a sharp edge its place. Maps lie one within the other, and the finest that
// has a point answers.
#ifndef NEPH_CLOUD_SHADOW_GLSL
#define NEPH_CLOUD_SHADOW_GLSL

#include "sun_cache.glsl"

const uint SHADOW_ENDS = 2; // of the shapes on a texel's ray, before its depths

// Less comes through as nothing: the logarithm of 0 is no depth.
const float LEAST_THROUGH = 1e-37;

// In the buffer of both.
uint shadow_texel(uint level, uvec2 texel)
{
    uint side = frame.shadow.texels;
    uint words = SHADOW_ENDS + SUN_CHANNELS * frame.shadow.layers;
    return frame.shadow.first + words * (texel.x + side * (texel.y + side * level));
}

// What comes to a place on a texel's ray.
vec3 texel_through(uint at, float along_m)
{
    uint layers = own(frame.shadow.layers);
    float end_m = sun_depths[at], begin_m = sun_depths[at + 1u];
    float place = clamp((along_m - end_m) / max(begin_m - end_m, 1e-6), 0.0, 1.0) * float(layers);
    uint layer = min(uint(place), layers - 1u);
    uint here = at + SHADOW_ENDS + SUN_CHANNELS * layer;
    bool is_last = layer + 1u == layers;
    vec3 depth = vec3(0.0);
    for (uint c = 0; c < SUN_CHANNELS; c++) {
        float next = is_last ? 0.0 : sun_depths[here + SUN_CHANNELS + c];
        depth[c] = mix(sun_depths[here + c], next, place - float(layer));
    }
    return COLOURED ? transmittance(depth) : vec3(transmittance(depth.x));
}

// Between the four texels around a place in texels.
vec3 level_through(uint level, vec2 place, float along_m)
{
    uvec2 low = uvec2(min(floor(place), vec2(frame.shadow.texels - 2u)));
    vec2 part = place - vec2(low);
    vec3 lower = mix(texel_through(shadow_texel(level, low), along_m),
                     texel_through(shadow_texel(level, low + uvec2(1, 0)), along_m), part.x);
    vec3 upper = mix(texel_through(shadow_texel(level, low + uvec2(0, 1)), along_m),
                     texel_through(shadow_texel(level, low + uvec2(1, 1)), along_m), part.x);
    return mix(lower, upper, part.y);
}

// Optical depth of all shapes towards the sun; false where no map reaches.
bool find_mapped_sun_depth(vec3 point_m, out vec3 depth)
{
    vec2 place_m = vec2(dot(point_m, frame.shadow.across_u) + frame.shadow.across_u_m,
                        dot(point_m, frame.shadow.across_v) + frame.shadow.across_v_m);
    float along_m = dot(point_m, frame.shadow.along) + frame.shadow.along_m;
    for (uint level = 0; level < own(frame.shadow.level_count); level++) {
        vec2 place = (place_m - frame.shadow.levels[level].low_m) *
                     frame.shadow.levels[level].per_m;
        if (any(lessThan(place, vec2(0.0))) ||
            any(greaterThan(place, vec2(frame.shadow.texels - 1u))))
            continue;
        depth = -log(max(level_through(level, place, along_m), vec3(LEAST_THROUGH)));
        return true;
    }
    depth = vec3(0.0);
    return false;
}

#endif

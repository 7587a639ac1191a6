// SPDX-License-Identifier: MIT
//
// The shadow map of clouds: the sunlight that all shapes (all media but fogs) transmit. Filled by
// cloud_shadow.comp, used by march_light.glsl for points between clouds and on solids.
//
// A texel is one sun ray. It stores the two ends of the clouds on the ray [m along the ray], then
// for each layer the optical depth towards the sun:
//
//            end                              begin
//   far  ----|--------|--------|--------|-----|---- sun
//            layer 0  1        2        3     depth 0
//
// Layer 0 is the end away from the sun and has the whole optical depth. With one layer this is the
// beer shadow map of S. Hillaire, "Physically Based Sky, Atmosphere and Cloud Rendering in
// Frostbite" (SIGGRAPH 2016 course); more layers approximate T. Lokovic and E. Veach, "Deep Shadow
// Maps" (SIGGRAPH 2000).
//
// Between texels the transmittance is interpolated, not the optical depth: this keeps the mean
// light on the ground and the position of sharp shadow edges. Levels are nested; a lookup uses the
// finest level that contains the point.
#ifndef NEPH_CLOUD_SHADOW_GLSL
#define NEPH_CLOUD_SHADOW_GLSL

#include "sun_cache.glsl"

const uint SHADOW_ENDS = 2; // words of a texel before its optical depths: end and begin

// Smallest transmittance: its optical depth, -log(), stays finite.
const float LEAST_THROUGH = 1e-37;

// First word of a texel, in the buffer that the map shares with the sun cache (sun_cache.glsl).
uint shadow_texel(uint level, uvec2 texel)
{
    uint side = frame.shadow.texels;
    uint words = SHADOW_ENDS + SUN_CHANNELS * frame.shadow.layers;
    return frame.shadow.first + words * (texel.x + side * (texel.y + side * level));
}

// Transmittance towards the sun at the distance `along_m` on a texel's ray: optical depths of the
// two layers around it are interpolated linearly. The depth beyond the last layer is 0.
vec3 texel_through(uint at, float along_m)
{
    uint layers = make_nonuniform(frame.shadow.layers);
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

// Bilinear interpolation of transmittance at a position in texels.
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

// Optical depth of all shapes from a point towards the sun, from the finest level that contains it;
// false when no level does.
bool find_mapped_sun_depth(vec3 point_m, out vec3 depth)
{
    vec2 place_m = vec2(dot(point_m, frame.shadow.across_u) + frame.shadow.across_u_m,
                        dot(point_m, frame.shadow.across_v) + frame.shadow.across_v_m);
    float along_m = dot(point_m, frame.shadow.along) + frame.shadow.along_m;
    for (uint level = 0; level < make_nonuniform(frame.shadow.level_count); level++) {
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

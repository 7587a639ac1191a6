// SPDX-License-Identifier: MIT
//
// Horizon clouds, after A. Schneider, "The Real-time Volumetric Cloudscapes of Horizon: Zero Dawn"
// (SIGGRAPH 2015) and F. Haggstrom, "Real-time rendering of volumetric clouds" (2018).
// scenes/horizon.h has all formulas; this is their float32 version on the same textures. Names in
// capitals below (SA, DA, E) are the names there.
//
// The camera's place in each texture is computed in double precision on the CPU, so lookups are
// accurate wherever the camera is. The including shader declares `horizon_texels[]`.
#ifndef NEPH_HORIZON_GLSL
#define NEPH_HORIZON_GLSL

#include "globe.glsl"
#include "stretch.glsl"

const int HORIZON_BASE_SIDE = NEPH_GPU_HORIZON_BASE_SIDE;
const int HORIZON_DETAIL_SIDE = NEPH_GPU_HORIZON_DETAIL_SIDE;
const int HORIZON_WEATHER_SIDE = NEPH_GPU_HORIZON_WEATHER_SIDE;

struct Horizon {
    Globe globe;         // of the bottom of the cloud layer
    vec3 base_at;        // the camera's place in the base noise [texels], from texel (0, 0, 0)
    float base_per_m;    // texels
    vec3 detail_at;
    float detail_per_m;
    vec2 weather_at;     // along x, z
    float weather_per_m;
    float thickness_m;   // of the layer
    float coverage;      // gc
    float density;       // gd
    float erosion;       // .8 e^(-.75 gc)
    // Index in horizon_texels[]: base noise, then detail noise, then weather map.
    uint first;
};

// A point's density, and the quantities that lighting models use.
struct HorizonSample {
    float density;
    float without_detail; // density before the detail noise is subtracted
    float height;         // in the layer, 0..1
};

// Bound for texel numbers. Numbers of this size have no fraction left, and must still fit an
// integer.
const float HORIZON_TEXEL_MAX = 1e9;

// All channels at a place, interpolated linearly, with wrap-around; side is a power of two.
vec4 horizon_lookup(uint first, int side, vec3 at)
{
    at = clamp(at, vec3(-HORIZON_TEXEL_MAX), vec3(HORIZON_TEXEL_MAX));
    vec3 low = floor(at), between = at - low;
    ivec3 a = ivec3(low) & (side - 1), b = (ivec3(low) + 1) & (side - 1);
    uint y0 = first + uint(a.y * side), y1 = first + uint(b.y * side);
    uint z0 = uint(a.z * side * side), z1 = uint(b.z * side * side);
    uint x0 = uint(a.x), x1 = uint(b.x);
    vec4 y0z0 = mix(horizon_texels[x0 + y0 + z0], horizon_texels[x1 + y0 + z0], between.x);
    vec4 y1z0 = mix(horizon_texels[x0 + y1 + z0], horizon_texels[x1 + y1 + z0], between.x);
    vec4 y0z1 = mix(horizon_texels[x0 + y0 + z1], horizon_texels[x1 + y0 + z1], between.x);
    vec4 y1z1 = mix(horizon_texels[x0 + y1 + z1], horizon_texels[x1 + y1 + z1], between.x);
    return mix(mix(y0z0, y1z0, between.y), mix(y0z1, y1z1, between.y), between.z);
}

vec4 horizon_lookup(uint first, int side, vec2 at)
{
    at = clamp(at, vec2(-HORIZON_TEXEL_MAX), vec2(HORIZON_TEXEL_MAX));
    vec2 low = floor(at), between = at - low;
    ivec2 a = ivec2(low) & (side - 1), b = (ivec2(low) + 1) & (side - 1);
    uint y0 = first + uint(a.y * side), y1 = first + uint(b.y * side);
    uint x0 = uint(a.x), x1 = uint(b.x);
    return mix(mix(horizon_texels[x0 + y0], horizon_texels[x1 + y0], between.x),
               mix(horizon_texels[x0 + y1], horizon_texels[x1 + y1], between.x), between.y);
}

float clamp01(float x) { return clamp(x, 0.0, 1.0); }

float horizon_octaves(vec3 octaves) { return dot(octaves, vec3(0.625, 0.25, 0.125)); }

// Coverage w: the low coverage, or the high coverage weighted by how far gc exceeds 0.5.
float horizon_coverage(Horizon horizon, vec4 weather)
{
    return horizon.coverage * max(weather.x, 2.0 * weather.y * clamp01(horizon.coverage - 0.5));
}

// Height shape SA; a peak of 0 leaves no height for a cloud.
float horizon_height_shape(float height, float peak)
{
    float above_bottom = clamp01(height / 0.07);
    return peak > 0.0 ? above_bottom * clamp01(1.0 - 1.125 * (height / peak - 0.2)) : 0.0;
}

// Height mass DA.
float horizon_mass(Horizon horizon, float height, float weather_density)
{
    return 2.0 * horizon.density * weather_density * height * clamp01(height / 0.15) *
           clamp01(1.0 - 8.0 * (height - 0.9));
}

// Erosion E.
float horizon_erosion(Horizon horizon, vec3 octaves, float height)
{
    float sum = horizon_octaves(octaves);
    float detail = sum > 0.0 ? clamp01((octaves.x - 1.0 + sum) / sum) : 0.0;
    return horizon.erosion * mix(detail, 1.0 - detail, clamp01(1.8 * height));
}

// Density at a point. Texture lookups are skipped as soon as an upper bound shows an empty point.
HorizonSample horizon_sample(Horizon horizon, vec3 point_m)
{
    float height = globe_altitude_m(horizon.globe, point_m) / horizon.thickness_m;
    HorizonSample result = HorizonSample(0.0, 0.0, clamp01(height));
    if (!(height >= 0.0 && height <= 1.0))
        return result;
    const uint BASE_TEXELS = uint(HORIZON_BASE_SIDE * HORIZON_BASE_SIDE * HORIZON_BASE_SIDE);
    const uint DETAIL_TEXELS =
        uint(HORIZON_DETAIL_SIDE * HORIZON_DETAIL_SIDE * HORIZON_DETAIL_SIDE);
    vec4 weather = horizon_lookup(horizon.first + BASE_TEXELS + DETAIL_TEXELS, HORIZON_WEATHER_SIDE,
                                  horizon.weather_at + point_m.xz * horizon.weather_per_m);
    float coverage = horizon_coverage(horizon, weather);
    float profile = horizon_height_shape(height, weather.z);
    if (profile - 1.0 + coverage <= 0.0) // base noise is at most 1
        return result;
    vec4 noise = horizon_lookup(horizon.first, HORIZON_BASE_SIDE,
                                horizon.base_at + point_m * horizon.base_per_m);
    float octaves = horizon_octaves(noise.yzw);
    float base = profile * (noise.x + 1.0 - octaves) / (2.0 - octaves);
    if (base - 1.0 + coverage <= 0.0) // beyond this line coverage > 0
        return result;
    float shape = clamp01((base - 1.0 + coverage) / coverage);
    float mass = horizon_mass(horizon, height, weather.w);
    vec4 detail = horizon_lookup(horizon.first + BASE_TEXELS, HORIZON_DETAIL_SIDE,
                                 horizon.detail_at + point_m * horizon.detail_per_m);
    float eroded = horizon_erosion(horizon, detail.xyz, height);
    result.density = clamp01((shape - eroded) / (1.0 - eroded)) * mass;
    result.without_detail = shape * mass;
    return result;
}

float horizon_density(Horizon horizon, vec3 point_m)
{
    return horizon_sample(horizon, point_m).density;
}

// Clips `inside` to the hull of the cloud layer along a ray.
void horizon_narrow(Horizon horizon, vec3 origin_m, vec3 direction, inout Stretch inside)
{
    globe_hull(horizon.globe, origin_m, direction, 0.0, horizon.thickness_m, inside.t0_m,
               inside.t1_m);
}

#endif

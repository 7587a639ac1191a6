// SPDX-License-Identifier: MIT
//
// This frame's rays around a texel of the reconstruction: the rays of 3x3 tiles.
#ifndef NEPH_REALTIME_RAYS_AROUND_GLSL
#define NEPH_REALTIME_RAYS_AROUND_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"

struct Ray {
    vec4 value;    // radiance of the medium in W/(m2 sr), transmittance
    float depth_m; // of the scene, where the ray ends
    bool is_usable;
    bool is_sky; // false unless a setting compares kinds
};

// The order in which ties are decided, by the place of the tile; 0 is the texel's own tile:
//     8 4 7
//     2 0 1
//     6 3 5
const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1),
                                 ivec2(1, 1), ivec2(-1, 1), ivec2(1, -1), ivec2(-1, -1));

ivec2 ray_tile(ivec2 tile, int ray)
{
    ivec2 last = choice(RT_EDGE_TILES) == RT_EDGE_TILES_KEPT ? tile_count() - 1
                                                             : max(view_size() / 4 - 1, ivec2(0));
    return ray == 0 ? tile : clamp(tile + AROUND[ray], ivec2(0), last);
}

// The place at which the article reads the depths of the six neighbours whose offsets do not sum to
// 0. It uses two gathers of 2x2 texels, about the upper left and the lower right corner of the
// tile, at (4 * corner + origin) / buffer size, in a buffer of a quarter of that size, rounded up.
// Computed in integers here; the last bit of a normalised coordinate depends on the device.
ivec2 gathered_texel(ivec2 tile, ivec2 offset)
{
    int corner = offset.x + offset.y > 0 ? 1 : 0;
    ivec2 size = target_size(RT_DEPTH), size_quarter = target_size(RT_TILE);
    ivec2 found = (2 * (4 * (tile + corner) + view_origin()) * size_quarter + size) / (2 * size);
    return clamp(found - corner + offset, ivec2(0), size_quarter - 1);
}

// The half-resolution texel that a tile's ray goes through.
ivec2 ray_half_pixel(ivec2 tile, float slot)
{
    return min(2 * tile + slot_place(int(slot)), half_size() - 1);
}

ivec2 ray_half_pixel(ivec2 tile) { return ray_half_pixel(tile, fetch_tile(RT_TILE, tile).x); }

bool compares_kinds()
{
    return choice(RT_BOX_SAME_KIND) != 0 || choice(RT_FALLBACK) == RT_FALLBACK_BILATERAL ||
           choice(RT_FALLBACK_REJECTED) == RT_FALLBACK_BILATERAL;
}

// `found`: the tile's element of the tile index.
float ray_depth_m(ivec2 tile, int ray, vec4 found)
{
    ivec2 offset = AROUND[ray];
    bool is_gathered = choice(RT_GATHER) == RT_GATHER_NORMALISED && offset.x + offset.y != 0;
    precise float depth_m = TILE_UNIT_M * (is_gathered
                                               ? fetch(RT_TILE, gathered_texel(tile, offset)).y
                                               : found.y);
    return depth_m;
}

Ray load_ray(ivec2 tile, int i)
{
    ivec2 from = ray_tile(tile, i);
    vec4 found = fetch_tile(RT_TILE, from);
    Ray ray;
    ray.value = fetch_tile(RT_RAY, from);
    ray.depth_m = ray_depth_m(tile, i, found);
    ray.is_usable = !checks_validity() || is_sound(ray.value);
    ray.is_sky = compares_kinds() &&
                 is_sky(fetch_half(RT_HALF_DEPTH, ray_half_pixel(from, found.x)).x);
    return ray;
}

// One of the nine rays; each shader defines its own access.
Ray ray_at(int i);
vec4 ray_value(int i);

float depth_difference_m(float center_depth_m, int ray)
{
    precise float difference_m = abs(center_depth_m - ray_at(ray).depth_m);
    return difference_m;
}

// The ray nearest in depth among those from `first` on, the first of equal ones; -1 if none is
// usable. The article considers differences up to 20 km, the largest difference of limited depths;
// beyond them it takes the first ray.
int nearest_ray(float center_depth_m, int first)
{
    float least_m = choice(RT_CLAMP_PIXEL_DEPTH) != 0 ? FAR_M : setting(RT_SKY_M);
    int nearest = -1;
    [[unroll]] for (int i = 0; i < 9; i++) {
        if (i < first || !ray_at(i).is_usable)
            continue;
        float difference_m = depth_difference_m(center_depth_m, i);
        if (difference_m < least_m || nearest < 0)
            nearest = i;
        if (difference_m < least_m)
            least_m = difference_m;
    }
    return nearest;
}

#endif

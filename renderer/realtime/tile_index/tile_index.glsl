// SPDX-License-Identifier: MIT
//
// The choice of a tile's slot (tile_index.comp).
#ifndef NEPH_REALTIME_TILE_INDEX_GLSL
#define NEPH_REALTIME_TILE_INDEX_GLSL

#include "slots.glsl"

bool is_sequential() { return choice(RT_OVERRIDE) == RT_OVERRIDE_SEQUENTIAL; }

// Whether any tile of the view may override in this frame (override_rest).
bool can_override()
{
    return choice(RT_OVERRIDE) != RT_OVERRIDE_NONE && force_nonuniform(view.resting) == 0u;
}

// The distance that Unreal gives a depth buffer's 0, which the article reads here [m].
const float OVERRIDE_SKY_M = 1e6;
// Relative difference of depth up to which a neighbouring ray covers a depth, from the article.
const float OVERRIDE_DEPTH = 0.25;

float compared_depth_m(float depth_m)
{
    float sky_m = choice(RT_FAR) == RT_FAR_INFINITE ? uintBitsToFloat(0x7f800000u)
                                                    : OVERRIDE_SKY_M;
    return is_sky(depth_m) ? sky_m : depth_m;
}

// Whether a ray's depth covers another depth. False for infinite ones, without computing a NaN.
bool covers(float ray_m, float depth_m)
{
    precise float difference_m = abs(depth_m - ray_m);
    precise float allowed_m = OVERRIDE_DEPTH * ray_m;
    bool are_finite = choice(RT_FAR) != RT_FAR_INFINITE || (is_finite(ray_m) && is_finite(depth_m));
    return are_finite && difference_m < allowed_m;
}

// The colour of a tile within 2x2 tiles: the number of the phase in which it chooses its slot.
uint find_tile_phase(ivec2 tile) { return uint((tile.x & 1) + 2 * (tile.y & 1)); }

// Depth of a neighbour's ray for the comparison [m], with the slot that the neighbour has at this
// point; each shader defines its own access.
float neighbour_ray_m(ivec2 neighbour);

// The slot of a tile after the override, from the eye depths of its four slots [m].
int overridden_slot(ivec2 tile, float depths_m[4])
{
    int nearest = 0, farthest = 0;
    for (int slot = 1; slot < 4; slot++) {
        if (depths_m[slot] < depths_m[nearest])
            nearest = slot;
        if (depths_m[slot] > depths_m[farthest])
            farthest = slot;
    }
    bool near_is_covered = false, far_is_covered = false;
    for (int i = 0; i < 9; i++) {
        if (i == 4)
            continue;
        ivec2 neighbour = clamp(tile + ivec2(i % 3, i / 3) - 1, ivec2(0), tile_count() - 1);
        float ray_m = neighbour_ray_m(neighbour);
        near_is_covered = near_is_covered || covers(ray_m, compared_depth_m(depths_m[nearest]));
        far_is_covered = far_is_covered || covers(ray_m, compared_depth_m(depths_m[farthest]));
    }
    if (!near_is_covered)
        return nearest;
    return far_is_covered ? default_slot(tile) : farthest;
}

void put_chosen(ivec2 tile, int chosen, float depths_m[4])
{
    precise float units = stored_depth_m(depths_m[chosen]) * TILE_UNITS_PER_M;
    put_tile(RT_TILE, tile, vec4(float(chosen), units, 0.0, 0.0));
}

bool is_tile(ivec2 tile)
{
    return all(greaterThanEqual(tile, ivec2(0))) && all(lessThan(tile, tile_count()));
}

#endif

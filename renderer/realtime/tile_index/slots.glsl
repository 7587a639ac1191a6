// SPDX-License-Identifier: MIT
//
// Tiles of 2x2 half-resolution texels: which of the four, the slots, has a ray in which frame, and
// the depth that rays and texels are compared by. check_reference_slots.h is its CPU
// reference.
#ifndef NEPH_REALTIME_SLOTS_GLSL
#define NEPH_REALTIME_SLOTS_GLSL

#include "renderer/realtime/shared/view.glsl"

// A tile keeps its depth in units of 10 km. A product with 1e-4 is rounded the same way everywhere,
// a quotient is not.
const float TILE_UNIT_M = 1e4;
const float TILE_UNITS_PER_M = 1e-4;

ivec2 target_size(int target)
{
    return ivec2(view.targets[target].width, view.targets[target].height);
}

// By RT_SLOT_ORDER_*.
const ivec2 SLOT_PLACES[4][4] = ivec2[4][4](
    ivec2[4](ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 1)),
    ivec2[4](ivec2(0, 0), ivec2(1, 0), ivec2(0, 1), ivec2(1, 1)),
    ivec2[4](ivec2(0, 0), ivec2(1, 1), ivec2(1, 0), ivec2(0, 1)),
    ivec2[4](ivec2(0, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, 0)));

// Where in its tile a slot lies, in half-resolution texels.
ivec2 slot_place(int slot) { return SLOT_PLACES[choice(RT_SLOT_ORDER)][slot]; }

// The slot of a half-resolution texel in its tile.
int slot_of(ivec2 half_pixel)
{
    int slot = 0;
    while (slot < 3 && slot_place(slot) != (half_pixel & 1))
        slot++;
    return slot;
}

// The slots take turns; the tiles on the white squares of a checkerboard are one ahead, so that
// near and far depths of 3x3 tiles have rays in every frame. That is so in the clockwise order; in
// the raster order two frames of four are blind to one of them.
int default_slot(ivec2 tile)
{
    bool is_ahead = choice(RT_SLOT_CHECKERBOARD) != 0 && (tile.x & 1) == (tile.y & 1);
    return int((view_frame + (is_ahead ? 1u : 0u)) & 3u);
}

// With gradient = on a tile takes the same numbers of ray_dither in two turns of its slots; the
// tiles on the black squares are one turn ahead.
uint turn_of(ivec2 tile) { return (view_frame >> 2) + uint((tile.x ^ tile.y) & 1); }

bool repeats_ray(ivec2 tile) { return (turn_of(tile) & 1u) != 0u; }

bool is_sky(float depth_m) { return depth_m >= FAR_M; }

// With the sky at `sky_m` and solids before ray_depth_max_m, in either format of the target.
float limited_depth_m(float depth_m, float sky_m)
{
    float limited_m = is_sky(depth_m) ? sky_m : min(depth_m, setting(RT_RAY_DEPTH_MAX_M));
    return min(limited_m, HALF_MAX * TILE_UNIT_M);
}

// The depth that a ray is stored with.
float stored_depth_m(float depth_m) { return limited_depth_m(depth_m, setting(RT_SKY_M)); }

#endif

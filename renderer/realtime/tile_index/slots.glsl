// SPDX-License-Identifier: MIT
//
// Tiles of 2x2 half-resolution texels: the slot schedule, which gives each frame one of a tile's
// four texels (slots) to march, and the depth by which rays and texels are compared.
// check_reference_slots.h is the CPU reference.
#ifndef NEPH_REALTIME_SLOTS_GLSL
#define NEPH_REALTIME_SLOTS_GLSL

#include "renderer/realtime/shared/view.glsl"

// A tile stores its depth in units of 10 km. A product with 1e-4 is rounded the same way on all
// devices, a quotient is not.
const float TILE_UNIT_M = 1e4;
const float TILE_UNITS_PER_M = 1e-4;

ivec2 target_size(int target)
{
    return ivec2(view.targets[target].width, view.targets[target].height);
}

// The place of each slot in its tile, indexed by RT_SLOT_ORDER_*:
//
//     clockwise   raster   diagonal   anticlockwise
//       0 1        0 1       0 2          0 3
//       3 2        2 3       3 1          1 2
const ivec2 SLOT_PLACES[4][4] = ivec2[4][4](
    ivec2[4](ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 1)),
    ivec2[4](ivec2(0, 0), ivec2(1, 0), ivec2(0, 1), ivec2(1, 1)),
    ivec2[4](ivec2(0, 0), ivec2(1, 1), ivec2(1, 0), ivec2(0, 1)),
    ivec2[4](ivec2(0, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, 0)));

// The place of a slot in its tile, in half-resolution texels.
ivec2 slot_place(int slot) { return SLOT_PLACES[choice(RT_SLOT_ORDER)][slot]; }

// The slot of a half-resolution texel in its tile.
int find_slot(ivec2 half_pixel)
{
    int slot = 0;
    while (slot < 3 && slot_place(slot) != (half_pixel & 1))
        slot++;
    return slot;
}

// The slot schedule: each slot in one of four frames. Tiles on the white squares of a checkerboard
// are one slot ahead, so that 3x3 tiles have rays at near and at far depths in every frame. That is
// true in the clockwise order; in the raster order two frames of four lack one of the two.
int default_slot(ivec2 tile)
{
    bool is_ahead = choice(RT_SLOT_CHECKERBOARD) != 0 && (tile.x & 1) == (tile.y & 1);
    return int((view_frame + (is_ahead ? 1u : 0u)) & 3u);
}

// With gradient = on a tile uses the same ray_dither numbers in two consecutive cycles of its
// slots; tiles on the black squares are one cycle ahead.
uint find_schedule_cycle(ivec2 tile) { return (view_frame >> 2) + uint((tile.x ^ tile.y) & 1); }

bool repeats_ray(ivec2 tile) { return (find_schedule_cycle(tile) & 1u) != 0u; }

bool is_sky(float depth_m) { return depth_m >= FAR_M; }

// The sky is at `sky_m`, solids end at ray_depth_max_m; representable in both formats of the
// target.
float limited_depth_m(float depth_m, float sky_m)
{
    float limited_m = is_sky(depth_m) ? sky_m : min(depth_m, setting(RT_RAY_DEPTH_MAX_M));
    return min(limited_m, HALF_MAX * TILE_UNIT_M);
}

// The depth that is stored with a ray.
float stored_depth_m(float depth_m) { return limited_depth_m(depth_m, setting(RT_SKY_M)); }

#endif

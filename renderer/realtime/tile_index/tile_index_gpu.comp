#version 450
// SPDX-License-Identifier: MIT
//
// The tile index (tile_index.comp) with a sequential override for a GPU, where the overhead of a
// dispatch exceeds its work: one dispatch in place of four. A work group processes all colours of
// its block of 8x8 tiles, and of the three tiles on each side that the block depends on (each tile
// depends on its neighbours of the colour before). The block also writes its part of the depth map,
// in place of the pass "depth map".
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/depth_map/depth_map.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "tile_index.glsl"

const int HALO = 3, AREA = RT_COLOUR_BLOCK + 2 * HALO; // tiles
shared int area_slots[AREA * AREA];          // of the tiles that have chosen
shared float area_rays_m[AREA * AREA];       // compared depths of the slots chosen so far
shared float area_depths_m[4 * AREA * AREA]; // of all slots, row by row of half-resolution texels
ivec2 area_corner;                           // the first tile
uint colour;                                 // the present phase

bool makes_depth_map() { return choice(RT_DEPTH_MAP_PASS) == RT_DEPTH_MAP_PASS_TILE_INDEX; }

// --- depths -----------------------------------------------------------------------------------

float half_depth_m(ivec2 half_pixel)
{
    return makes_depth_map() ? mapped_depth_m(clamp(half_pixel, ivec2(0), half_size() - 1))
                             : fetch_half(RT_HALF_DEPTH, half_pixel).x;
}

// The place of a tile, and of a half-resolution texel, in the area.
int tile_index(ivec2 at) { return at.x + AREA * at.y; }

int depth_index(ivec2 at) { return at.x + 2 * AREA * at.y; }

// Run by all threads of a group. All depths of the area are loaded before the first is stored.
void load_depths()
{
    const int count = 4 * AREA * AREA, turns = (count - 1) / GROUP_THREADS + 1;
    int thread = int(gl_LocalInvocationID.x);
    float depths_m[turns];
    [[unroll]] for (int k = 0; k < turns; k++) {
        int i = min(thread + GROUP_THREADS * k, count - 1);
        depths_m[k] = half_depth_m(2 * area_corner + ivec2(i % (2 * AREA), i / (2 * AREA)));
    }
    [[unroll]] for (int k = 0; k < turns; k++)
        if (thread + GROUP_THREADS * k < count)
            area_depths_m[thread + GROUP_THREADS * k] = depths_m[k];
    barrier();
}

float slot_depth_m(ivec2 tile, int slot)
{
    return area_depths_m[depth_index(2 * (tile - area_corner) + slot_place(slot))];
}

// Range of the depths of the block and the tiles next to it; bits of positive floats sort like
// them.
shared uint least_depth, largest_depth;

// Loads these depths. Returns whether every depth covers every other one: then no tile of the block
// overrides, whatever the tiles around choose, and the outer part of the area is not needed.
bool is_smooth()
{
    const int side = 2 * (RT_COLOUR_BLOCK + 2), count = side * side;
    const int turns = (count - 1) / GROUP_THREADS + 1;
    int thread = int(gl_LocalInvocationID.x);
    float depths_m[turns];
    uint least = 0xffffffffu, largest = 0u;
    if (thread == 0) {
        least_depth = least;
        largest_depth = largest;
    }
    barrier();
    [[unroll]] for (int k = 0; k < turns; k++) {
        int i = min(thread + GROUP_THREADS * k, count - 1);
        ivec2 at = 2 * (HALO - 1) + ivec2(i % side, i / side);
        depths_m[k] = half_depth_m(2 * area_corner + at);
    }
    [[unroll]] for (int k = 0; k < turns; k++) {
        int i = min(thread + GROUP_THREADS * k, count - 1);
        area_depths_m[depth_index(2 * (HALO - 1) + ivec2(i % side, i / side))] = depths_m[k];
        uint depth = floatBitsToUint(compared_depth_m(depths_m[k]));
        least = min(least, depth);
        largest = max(largest, depth);
    }
    atomicMin(least_depth, least);
    atomicMax(largest_depth, largest);
    barrier();
    return covers(uintBitsToFloat(least_depth), uintBitsToFloat(largest_depth));
}

void put_depth_map()
{
    const int side = 2 * RT_COLOUR_BLOCK;
    ivec2 first = 2 * (area_corner + HALO);
    for (int i = int(gl_LocalInvocationID.x); i < side * side; i += GROUP_THREADS) {
        ivec2 in_block = ivec2(i % side, i / side), at = in_block + 2 * HALO;
        if (all(lessThan(first + in_block, half_size())))
            put_half(RT_HALF_DEPTH, first + in_block, vec4(area_depths_m[depth_index(at)]));
    }
}

// --- slots ------------------------------------------------------------------------------------

float neighbour_ray_m(ivec2 neighbour) { return area_rays_m[tile_index(neighbour - area_corner)]; }

float[4] tile_depths_m(ivec2 tile)
{
    float depths_m[4];
    for (int slot = 0; slot < 4; slot++)
        depths_m[slot] = slot_depth_m(tile, slot);
    return depths_m;
}

// Stores the rays of the scheduled slots, before the first colour. Run by all threads of a group.
void share_rays()
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA * AREA; i += GROUP_THREADS) {
        ivec2 tile = area_corner + ivec2(i % AREA, i / AREA);
        area_rays_m[i] = compared_depth_m(slot_depth_m(tile, default_slot(tile)));
    }
    barrier();
}

// Chooses the slots of one colour in the area, one thread a tile. Tiles that no later colour
// depends on are skipped: a border as wide as the number of earlier colours.
void choose_colour(int thread)
{
    const int side = AREA / 2;
    ivec2 parity = (ivec2(colour, colour >> 1) + HALO) & 1; // the area's first tile is odd
    ivec2 at = 2 * ivec2(thread % side, thread / side) + parity;
    ivec2 tile = area_corner + at;
    bool is_within = all(greaterThanEqual(at, ivec2(colour))) &&
                     all(lessThan(at, ivec2(AREA - int(colour))));
    if (!(thread < side * side && is_within && is_tile(tile)))
        return;
    int slot = overridden_slot(tile, tile_depths_m(tile));
    area_slots[tile_index(at)] = slot;
    area_rays_m[tile_index(at)] = compared_depth_m(slot_depth_m(tile, slot));
}

void main()
{
    int thread = int(gl_LocalInvocationID.x);
    ivec2 first = find_block(tile_count(), ivec2(RT_COLOUR_BLOCK));
    ivec2 tile = first + ivec2(thread % RT_COLOUR_BLOCK, thread / RT_COLOUR_BLOCK);
    area_corner = first - HALO;
    bool overrides = !is_smooth() && can_override();
    if (overrides) {
        load_depths();
        share_rays();
    }
    if (makes_depth_map())
        put_depth_map();
    for (colour = 0; overrides && colour < 4; colour++) {
        choose_colour(thread);
        barrier();
    }
    if (!is_tile(tile))
        return;
    int slot = overrides ? area_slots[tile_index(tile - area_corner)] : default_slot(tile);
    put_chosen(tile, slot, tile_depths_m(tile));
}

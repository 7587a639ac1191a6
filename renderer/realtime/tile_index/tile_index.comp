#version 450
// SPDX-License-Identifier: MIT
//
// The tile index: which of its four half-resolution texels, its slots, a tile marches in this
// frame, and how deep that one is.
//
// The slots take turns. Where none of the eight rays around stands for the depth of a tile's
// nearest texel, the tile marches that one; else, where none stands for the farthest, that one.
// This is the override: history has to be held among rays of its own depth. In parallel all tiles
// may take each other for the default and all change together: bars with the pitch of the tiles
// flash with a period of four frames. Sequential is four dispatches, one for each colour
//     0 1
//     2 3
// of 2x2 tiles; a tile sees what earlier colours chose and what later ones would by default. On a
// GPU, where a dispatch waits longer than it works, it is one: a work group takes its 8x8 tiles
// through all colours by itself, and with them as many tiles around as these depend on, three on
// each side: a tile looks at its neighbours of the colour before, and so on. There it also makes
// the depth map of its block (depth_map_pass).
//
// "Nearest" and "farthest" go by the scene's depth, in which the sky is the farthest whatever
// override_sky_m says. The comparison goes by unlimited depths: ray_depth_max_m is for what is
// stored. With `far` = infinite the sky's own depth is infinite there, and |inf - inf| < inf / 4 is
// false: no ray of the sky covers the sky, and a tile of sky marches slot 0 for ever. What is
// stored of the sky is sky_m in both cases.
//
// `gather` = normalised finds the texels by the article's normalised coordinates. They fall on the
// corner between the four, and in sizes that are no multiple of 4 they drift by less than the half
// texel that would matter: the four found are the right ones, but not held within the view. The
// harm of these coordinates is in the reconstruction. `tile_origin` = buffer forgets the view's
// origin for the tile itself, but not for its neighbours.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/depth_map/depth_map.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "slots.glsl"

bool is_sequential() { return choice(RT_OVERRIDE) == RT_OVERRIDE_SEQUENTIAL; }

const int HALO = 3, AREA = RT_COLOUR_BLOCK + 2 * HALO;
shared int area_slots[AREA * AREA]; // of a block and its halo, as far as they are chosen
shared float area_depths_m[4 * AREA * AREA]; // of all slots, row by row of half-resolution texels
shared float area_rays_m[AREA * AREA]; // as compared: of the slots that are chosen so far

ivec2 area_corner; // its first tile; on a GPU

// A tile's own depths may lie elsewhere (tile_origin).
bool has_area_depths() { return choice(RT_TILE_ORIGIN) == RT_TILE_ORIGIN_VIEW; }

// Whether rays are found by their place in an area.
bool shares_rays() { return ON_GPU && is_sequential() && has_area_depths(); }

// Whether the depth map is made here, by each group for its block.
bool makes_depth_map() { return choice(RT_DEPTH_MAP_PASS) == RT_DEPTH_MAP_PASS_TILE_INDEX; }

// Eye depth of a half-resolution texel, counted from an origin [m].
float half_depth_m(ivec2 half_pixel, ivec2 origin_px)
{
    if (makes_depth_map())
        return mapped_depth_m(min(half_pixel, half_size() - 1));
    ivec2 last = choice(RT_GATHER) == RT_GATHER_TEXEL ? origin_px / 2 + half_size() - 1
                                                      : target_size(RT_HALF_DEPTH) - 1;
    return fetch(RT_HALF_DEPTH, min(origin_px / 2 + half_pixel, last)).x;
}

// The place of a half-resolution texel in the area.
int area_index(ivec2 at) { return at.x + 2 * AREA * at.y; }

// Eye depth of one slot of a tile [m].
float slot_depth_m(ivec2 tile, int slot, ivec2 origin_px)
{
    ivec2 half_pixel = 2 * tile + slot_place(slot);
    if (!shares_rays())
        return half_depth_m(half_pixel, origin_px);
    ivec2 at = half_pixel - 2 * area_corner;
    return area_depths_m[area_index(at)];
}

// By all threads of a group: what four colours look at, one after the other, is fetched at once.
void fetch_area_depths()
{
    const int count = 4 * AREA * AREA, turns = (count - 1) / GROUP_THREADS + 1;
    int thread = int(gl_LocalInvocationID.x);
    float depths_m[turns];
    [[unroll]] for (int k = 0; k < turns; k++) {
        int i = min(thread + GROUP_THREADS * k, count - 1);
        ivec2 half_pixel = 2 * area_corner + ivec2(i % (2 * AREA), i / (2 * AREA));
        depths_m[k] = half_depth_m(max(half_pixel, ivec2(0)), view_origin());
    }
    [[unroll]] for (int k = 0; k < turns; k++)
        if (thread + GROUP_THREADS * k < count)
            area_depths_m[thread + GROUP_THREADS * k] = depths_m[k];
    barrier();
}

// What Unreal makes of a depth buffer's 0, which the article reads here [m].
const float OVERRIDE_SKY_M = 1e6;
// Relative difference of depth up to which a neighbouring ray stands for a depth: the article's.
const float OVERRIDE_DEPTH = 0.25;

float compared_depth_m(float depth_m)
{
    float sky_m = choice(RT_FAR) == RT_FAR_INFINITE ? uintBitsToFloat(0x7f800000u)
                                                    : OVERRIDE_SKY_M;
    return is_sky(depth_m) ? sky_m : depth_m;
}

// Whether a ray's depth stands for another one. False for infinite ones, without a NaN.
bool covers(float ray_m, float depth_m)
{
    precise float difference_m = abs(depth_m - ray_m);
    precise float allowed_m = OVERRIDE_DEPTH * ray_m;
    bool are_finite = choice(RT_FAR) != RT_FAR_INFINITE || (is_finite(ray_m) && is_finite(depth_m));
    return are_finite && difference_m < allowed_m;
}

// Depths of the block and the tiles next to it, as whole numbers, which are ordered like them.
shared uint least_depth, largest_depth;

// Whether all of these stand for each other, so that no tile of the block overrides, whatever those
// around choose; their own halo does not matter then. They are fetched.
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
        depths_m[k] = half_depth_m(max(2 * area_corner + at, ivec2(0)), view_origin());
    }
    [[unroll]] for (int k = 0; k < turns; k++) {
        int i = min(thread + GROUP_THREADS * k, count - 1);
        area_depths_m[area_index(2 * (HALO - 1) + ivec2(i % side, i / side))] = depths_m[k];
        uint depth = floatBitsToUint(compared_depth_m(depths_m[k]));
        least = min(least, depth);
        largest = max(largest, depth);
    }
    atomicMin(least_depth, least);
    atomicMax(largest_depth, largest);
    barrier();
    float least_m = uintBitsToFloat(least_depth), largest_m = uintBitsToFloat(largest_depth);
    return covers(least_m, largest_m);
}

void put_depth_map()
{
    const int side = 2 * RT_COLOUR_BLOCK;
    ivec2 first = 2 * (area_corner + HALO);
    for (int i = int(gl_LocalInvocationID.x); i < side * side; i += GROUP_THREADS) {
        ivec2 in_block = ivec2(i % side, i / side), at = in_block + 2 * HALO;
        if (all(lessThan(first + in_block, half_size())))
            put_half(RT_HALF_DEPTH, first + in_block, vec4(area_depths_m[area_index(at)]));
    }
}

uint colour_of(ivec2 tile) { return uint((tile.x & 1) + 2 * (tile.y & 1)); }

uint colour; // whose turn it is

int known_slot(ivec2 tile)
{
    ivec2 at = tile - area_corner;
    return ON_GPU ? area_slots[at.x + AREA * at.y] : int(fetch_tile(RT_TILE, tile).x);
}

int neighbour_slot(ivec2 tile)
{
    bool is_known = is_sequential() && colour_of(tile) < colour;
    return is_known ? known_slot(tile) : default_slot(tile);
}

// A block's are in shared memory, for all tiles that look at them.
float neighbour_ray_m(ivec2 neighbour)
{
    if (shares_rays()) {
        ivec2 at = neighbour - area_corner;
        return area_rays_m[at.x + AREA * at.y];
    }
    return compared_depth_m(slot_depth_m(neighbour, neighbour_slot(neighbour), view_origin()));
}

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

struct Depths {
    float of_slots_m[4];
};

Depths tile_depths(ivec2 tile)
{
    ivec2 origin_px = choice(RT_TILE_ORIGIN) == RT_TILE_ORIGIN_BUFFER ? ivec2(0) : view_origin();
    Depths depths;
    for (int slot = 0; slot < 4; slot++)
        depths.of_slots_m[slot] = slot_depth_m(tile, slot, origin_px);
    return depths;
}

void put_chosen(ivec2 tile, int chosen, Depths depths)
{
    precise float units = stored_depth_m(depths.of_slots_m[chosen]) * TILE_UNITS_PER_M;
    put_tile(RT_TILE, tile, vec4(float(chosen), units, 0.0, 0.0));
}

bool is_tile(ivec2 tile)
{
    return all(greaterThanEqual(tile, ivec2(0))) && all(lessThan(tile, tile_count()));
}

// The tiles of one colour in the area, a thread each: what later colours do not look at is left
// out, a rim as wide as there were colours before.
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
    int slot = overridden_slot(tile, tile_depths(tile).of_slots_m);
    area_slots[at.x + AREA * at.y] = slot;
    if (shares_rays())
        area_rays_m[at.x + AREA * at.y] =
            compared_depth_m(slot_depth_m(tile, slot, view_origin()));
}

// Those of the slots whose turn it is, before the first colour; by all threads of a group.
void share_rays()
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA * AREA; i += GROUP_THREADS) {
        ivec2 tile = area_corner + ivec2(i % AREA, i / AREA);
        area_rays_m[i] = compared_depth_m(slot_depth_m(tile, default_slot(tile), view_origin()));
    }
    barrier();
}

// The block of this work group.
void choose_block(bool may_override)
{
    int thread = int(gl_LocalInvocationID.x);
    ivec2 first = own_block(tile_count(), ivec2(RT_COLOUR_BLOCK));
    ivec2 in_block = ivec2(thread % RT_COLOUR_BLOCK, thread / RT_COLOUR_BLOCK);
    area_corner = first - HALO;
    if (has_area_depths()) {
        may_override = !is_smooth() && may_override;
        if (may_override) {
            fetch_area_depths();
            share_rays();
        }
    }
    if (makes_depth_map())
        put_depth_map();
    for (colour = 0; may_override && colour < 4; colour++) {
        choose_colour(thread);
        barrier();
    }
    ivec2 tile = first + in_block;
    if (!is_tile(tile))
        return;
    put_chosen(tile, may_override ? known_slot(tile) : default_slot(tile), tile_depths(tile));
}

// Where each colour has a dispatch, a thread has the tile of that colour in its 2x2.
bool own_tile(out ivec2 tile)
{
    if (!is_sequential())
        return own_element(tile_count(), tile);
    bool is_left = own_element((tile_count() + 1) / 2, tile);
    tile = 2 * tile + ivec2(run.colour & 1u, run.colour >> 1);
    return is_left && is_tile(tile);
}

void main()
{
    bool may_override = choice(RT_OVERRIDE) != RT_OVERRIDE_NONE && of_thread(view.resting) == 0u;
    if (ON_GPU && is_sequential()) {
        choose_block(may_override);
        return;
    }
    ivec2 tile;
    if (!own_tile(tile))
        return;
    colour = run.colour;
    Depths depths = tile_depths(tile);
    put_chosen(tile, may_override ? overridden_slot(tile, depths.of_slots_m) : default_slot(tile),
               depths);
}

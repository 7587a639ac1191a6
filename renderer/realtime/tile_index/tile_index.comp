#version 450
// SPDX-License-Identifier: MIT
//
// The tile index: the slot (one of four half-resolution texels) that a tile marches in this frame,
// and the depth of that texel. After F. Bauer, "Creating the Atmospheric World of Red Dead
// Redemption 2", SIGGRAPH 2019, as the article rebuilds it (docs/realtime.md).
//
//     slots of a tile, in the order of the schedule:              colours of 2x2 tiles:
//     0 1                                                         0 1
//     3 2                                                         2 3
//
// The slot override: where none of the eight rays around covers the depth of a tile's nearest
// texel, the tile marches that texel; else, where none covers the farthest, that one. History can
// then be clamped to rays of its own depth. With override = parallel all tiles decide at once, each
// as if the others kept their scheduled slots, and may all change together: bars with the pitch of
// the tiles then flash with a period of four frames. Sequential is four dispatches, one for each
// colour: a tile reads the choices of earlier colours and the scheduled slots of later ones.
//
// "Nearest" and "farthest" refer to the scene's depth, in which the sky is the farthest for any
// OVERRIDE_SKY_M. Unlimited depths are compared: ray_depth_max_m applies to stored depths. With
// `far` = infinite the sky's depth is infinite, and |inf - inf| < inf / 4 is false: no ray of the
// sky covers the sky, and a tile of sky marches slot 0 in every frame. The stored depth of the sky
// is sky_m in both cases.
//
// `gather` = normalised reads the texels at the article's normalised coordinates. They fall on the
// corner between the four texels; in sizes that are not multiples of 4 they drift by less than half
// a texel, so the four texels are correct, but not clamped to the view. These coordinates do harm
// in the reconstruction. `tile_origin` = buffer omits the view's origin for the tile itself, but
// not for its neighbours.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"
#include "tile_index.glsl"

// Eye depth of a slot of a tile, relative to an origin [m].
float slot_depth_m(ivec2 tile, int slot, ivec2 origin_px)
{
    ivec2 half_pixel = 2 * tile + slot_place(slot);
    ivec2 last = choice(RT_GATHER) == RT_GATHER_TEXEL ? origin_px / 2 + half_size() - 1
                                                      : target_size(RT_HALF_DEPTH) - 1;
    return fetch(RT_HALF_DEPTH, min(origin_px / 2 + half_pixel, last)).x;
}

int neighbour_slot(ivec2 tile)
{
    bool has_chosen = is_sequential() && find_tile_phase(tile) < run.colour;
    return has_chosen ? int(fetch_tile(RT_TILE, tile).x) : default_slot(tile);
}

float neighbour_ray_m(ivec2 neighbour)
{
    return compared_depth_m(slot_depth_m(neighbour, neighbour_slot(neighbour), view_origin()));
}

// The tile of this thread; false for threads past the last. In a dispatch of one colour a thread
// processes the tile of that colour in its 2x2.
bool find_tile(out ivec2 tile)
{
    if (!is_sequential())
        return find_element(tile_count(), tile);
    bool is_left = find_element((tile_count() + 1) / 2, tile);
    tile = 2 * tile + ivec2(run.colour & 1u, run.colour >> 1);
    return is_left && is_tile(tile);
}

void main()
{
    bool overrides = can_override();
    ivec2 tile;
    if (!find_tile(tile))
        return;
    ivec2 origin_px = choice(RT_TILE_ORIGIN) == RT_TILE_ORIGIN_BUFFER ? ivec2(0) : view_origin();
    float depths_m[4];
    for (int slot = 0; slot < 4; slot++)
        depths_m[slot] = slot_depth_m(tile, slot, origin_px);
    put_chosen(tile, overrides ? overridden_slot(tile, depths_m) : default_slot(tile), depths_m);
}

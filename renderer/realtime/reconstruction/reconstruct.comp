#version 450
// SPDX-License-Identifier: MIT
//
// The reconstruction: the medium at half resolution, from this frame's rays, one for every four
// texels, and from the history. After F. Bauer, "Creating the Atmospheric World of Red Dead
// Redemption 2", SIGGRAPH 2019, as the article rebuilds it (docs/realtime.md).
//
// A tile of 2x2 half-resolution texels has one ray in this frame, through the texel R. Texels x
// have none. A texel uses nine rays: its tile's and those of the 3x3 tiles around.
//
//     R x | x x | x R        A texel with a ray takes it, unblended (fresh_weight = 1) or blended
//     x x | x R | x x        with its history. The others take their history, read at the place of
//     ----+-----+----        the medium in the frame before (history.glsl), and clamped to the box
//     x x | R x | x x        of those rays around that are as deep as the texel
//     x R | x x | R x        (clamp_history.glsl). Without history they take the ray that is
//     nearest ----+-----+----        in depth, or a mean (fallback).
//     R x | x x | x x
//     x x | x R | x R
//
// Faults of the article that settings keep:
// - box_centre = off: the tile's own ray is left out of the clamping box.
// - edge_tiles = dropped: neighbours end one tile early in sizes that are no multiple of 4.
// - gather = normalised: the depths of six neighbours are read at normalised coordinates, which in
//   such sizes point to the next tile after two thirds of the image.
// - clamp_pixel_depth = off: the texel's own depth is not limited like the depths of rays; geometry
//   farther than halfway between ray_depth_max_m and sky_m gets the sky's clouds.
// - reproject_depth = tile, reproject_measure = eye: the distance of the tile's ray is used for the
//   texel's cloud, and as an eye depth.
// - wind = off, validity = off: history does not follow the wind and is never invalid.
// A box of one ray erases the history, in the article and here. The article's weight of 0.5 for a
// fresh ray follows its return and has no effect. The sky's depth is sky_m here, also with `far` =
// infinite: the article says 20 km at this place.
//
// Invalid with validity = on: rays that are not finite or are negative, history of age 0 or with
// such values. History is rejected where the scene behind it has changed (reject_depth). Off the
// screen, behind the camera and after a cut (cut_reset) there is no history with validity = off
// either; the first frame then reads arbitrary memory. The age is the number of rays in a texel; a
// texel that took its first value from a neighbour's ray has age 1.
#extension GL_GOOGLE_include_directive : require

#include "reconstruct.glsl"
#include "renderer/realtime/shared/pass.glsl"

Ray rays[9];

void load_rays(ivec2 tile)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        rays[i] = load_ray(tile, i);
}

Ray ray_at(int i) { return rays[i]; }

// A selection among registers is cheaper than an index into memory.
vec4 ray_value(int ray)
{
    vec4 value = rays[0].value;
    [[unroll]] for (int i = 1; i < 9; i++)
        if (i == ray)
            value = rays[i].value;
    return value;
}

Change change_around_tile(ivec2 tile) { return load_change(RT_CHANGE, tile); }

// The texel of this thread; false for threads past the last. With output elision
// (renderer/realtime/output_elision.h) one thread a tile writes only the texel with a ray; the
// others keep their values in place.
bool find_texel(out ivec2 half_pixel)
{
    if (!is_output_elided())
        return find_element(half_size(), half_pixel);
    ivec2 tile;
    bool is_left = find_element(tile_count(), tile);
    half_pixel = ray_half_pixel(tile);
    return is_left;
}

void main()
{
    ivec2 half_pixel;
    if (!find_texel(half_pixel))
        return;
    load_rays(half_pixel / 2);
    reconstruct(half_pixel);
}

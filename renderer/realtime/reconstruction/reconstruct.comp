#version 450
// SPDX-License-Identifier: MIT
//
// The reconstruction: the medium at half resolution, from this frame's rays, one for every four
// texels, and from the frame before. After F. Bauer, "Creating the Atmospheric World of Red Dead
// Redemption 2", SIGGRAPH 2019, as the article rebuilds it (docs/realtime.md).
//
// A tile of 2x2 half-resolution texels has one ray in this frame, through the texel R. Texels x
// have none. A texel takes part in nine rays: its tile's and those of the 3x3 tiles around.
//
//     R x | x x | x R        A texel with a ray takes it, all of it (fresh_weight = 1) or blended
//     x x | x R | x x        with its history. The others take their history, looked up where the
//     ----+-----+----        medium was in the frame before (history.glsl), clamped to the box of
//     x x | R x | x x        those rays around that are as deep as the texel (clamp_history.glsl).
//     x R | x x | R x        Without history they take the ray that is nearest in depth, or a mean
//     ----+-----+----        (fallback).
//     R x | x x | x x
//     x x | x R | x R
//
// Faults of the article that settings keep:
// - box_centre = off: the tile's own ray is left out of the clamping box.
// - edge_tiles = dropped: neighbours end one tile early in sizes that are no multiple of 4.
// - gather = normalised: the depths of six neighbours are found by normalised coordinates, which in
//   such sizes come to the next tile after two thirds of the image.
// - clamp_pixel_depth = off: the texel's own depth is not limited as the rays' are; from halfway
//   between ray_depth_max_m and sky_m on geometry takes the sky's clouds.
// - reproject_depth = tile, reproject_measure = eye: the distance of the tile's ray stands for that
//   of the texel's cloud, and for an eye depth.
// - wind = off, validity = off: history does not follow the wind, and nothing is ever invalid.
// A box of one ray erases the history, in the article and here. The article's weight of 0.5 for a
// fresh ray stands behind its return and is never reached. The sky's depth is sky_m here with `far`
// = infinite too: the article says 20 km at this place.
//
// Invalid, and not used with validity = on: rays that are not finite or negative, history of age 0
// or with such values. History is rejected where the scene behind it has changed (reject_depth).
// Off the screen, behind the camera and after a cut (cut_reset) there is no history with validity =
// off either; the first frame then takes whatever the memory holds. The age counts the rays that
// went into a texel; a texel that borrowed its first value from a neighbour's ray is 1 old.
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

// A choice among known rays is cheaper than an index into memory.
vec4 ray_value(int ray)
{
    vec4 value = rays[0].value;
    [[unroll]] for (int i = 1; i < 9; i++)
        if (i == ray)
            value = rays[i].value;
    return value;
}

Change change_around_tile(ivec2 tile) { return change_of(RT_CHANGE, tile); }

// The texel of this thread; false when there is none left. Where nothing changes only texels with a
// ray are written, a thread for each tile: the others stay as they are, in their place
// (renderer/realtime/unread.h).
bool own_texel(out ivec2 half_pixel)
{
    if (!is_unread())
        return own_element(half_size(), half_pixel);
    ivec2 tile;
    bool is_left = own_element(tile_count(), tile);
    half_pixel = ray_half_pixel(tile);
    return is_left;
}

void main()
{
    ivec2 half_pixel;
    if (!own_texel(half_pixel))
        return;
    load_rays(half_pixel / 2);
    reconstruct(half_pixel);
}

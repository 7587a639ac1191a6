#version 450
// SPDX-License-Identifier: MIT
//
// The march: one ray a tile, through the half-resolution texel that the tile index selected, up to
// its depth; the code is shared with march.comp. A work group has a square of tiles, whose rays
// read the same voxels and diverge late; tiles of a square beyond the view are idle. A dithered
// start (blue noise on the tiles) turns the banding of few steps into noise, which later passes
// filter.
#extension GL_GOOGLE_include_directive : require

#define DRAWS_COVERAGE

#include "medium_ray.glsl"

#include "renderer/realtime/shared/dither.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

// With gradient=on each half-resolution texel (not each tile) has its own sequence of numbers: the
// noise of a whole frame, and the noise of a texel over time, then have the spectrum of the mask.
float read_ray_dither(ivec2 tile, ivec2 half_pixel)
{
    return choice(RT_GRADIENT) == 0
               ? dither(choice(RT_RAY_DITHER), tile, view_frame, 0u)
               : dither(choice(RT_RAY_DITHER), half_pixel, find_schedule_cycle(tile) >> 1, 0u);
}

// The tile of a ray, square by square, in Morton order within a square, x first: 8 consecutive
// rays, which lavapipe marches together, are 4x2 tiles, and 32 are 8x4:
//
//      0  1  4  5 16 17 20 21
//      2  3  6  7 18 19 22 23
//      8  9 12 13 24 25 28 29
//     10 11 14 15 26 27 30 31
ivec2 find_ray_tile(int ray)
{
    const int side = RT_MARCH_BLOCK;
    ivec2 squares = (tile_count() - 1) / side + 1;
    ray = deal_ray(ray, side * side * squares.x * squares.y);
    ivec2 square = element_at(ray / (side * side), squares.x);
    return side * square + ivec2(ray & 1 | ray >> 1 & 2 | ray >> 2 & 4,
                                 ray >> 1 & 1 | ray >> 2 & 2 | ray >> 3 & 4);
}

// Number of rays of a square, given by its first tile.
uint count_square_rays(ivec2 tile)
{
    ivec2 rest = min(tile_count() - tile, ivec2(RT_MARCH_BLOCK));
    return uint(rest.x * rest.y);
}

// `place`: of the sample in each step.
Ray make_texel_ray(ivec2 half_pixel, float place)
{
    vec2 place_px = vec2(2 * half_pixel + 1);
    if (choice(RT_JITTERED_DEPTH) != 0)
        place_px += jitter_px;
    return make_ray(place_px, fetch_half(RT_HALF_DEPTH, half_pixel).x, place);
}

// Which parts of meshes with alpha as coverage the shadow rays meet. By the numbers of
// read_ray_dither(), so that rays that are marched twice are equal.
void draw_ray_coverage(ivec2 tile, ivec2 half_pixel)
{
    set_coverage(uvec2(half_pixel),
                 choice(RT_GRADIENT) == 0 ? view_frame : find_schedule_cycle(tile) >> 1);
}

Ray make_tile_ray(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + slot_place(int(fetch_tile(RT_TILE, tile).x));
    half_pixel = min(half_pixel, half_size() - 1);
    draw_ray_coverage(tile, half_pixel);
    return make_texel_ray(half_pixel, mix(0.5, read_ray_dither(tile, half_pixel),
                                          setting(RT_RAY_DITHER_AMOUNT)));
}

void march_tile(uint thread)
{
    ivec2 tile = find_ray_tile(int(run.first_ray + thread));
    if (thread >= run.ray_count || any(greaterThanEqual(tile, tile_count())))
        return;
    MarchedRay marched;
    if (!march_ray(thread, make_tile_ray(tile), marched))
        return;
    put_tile(RT_RAY, tile, marched.value);
    put_tile(RT_RAY_DISTANCE, tile, vec4(marched.distance_m));
    if (!UNCOUNTED && gl_LocalInvocationIndex == 0u)
        atomicAdd(counters.rays, count_square_rays(tile));
    count_cost();
}

// --- the oracles --------------------------------------------------------------------------------
//
// Rays without noise, which are not counted: they measure what a shortcut costs.

layout(constant_id = RT_ROLE_CONSTANT) const int ROLE = RT_ROLE_ORDINARY;

// A half-resolution texel has its own ray. The reconstruction finds it in its own output.
void march_texel(uint thread)
{
    ivec2 half_pixel = element_at(int(run.first_ray + thread), half_size().x);
    MarchedRay marched;
    set_coverage(uvec2(half_pixel), view_frame);
    if (thread >= run.ray_count || !march_ray(thread, make_texel_ray(half_pixel, 0.5), marched))
        return;
    if (choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF)
        marched.value = min(marched.value, vec4(HALF_MAX));
    put_half(RT_HISTORY, half_pixel, marched.value);
    put_half(RT_HISTORY_STATE, half_pixel, vec4(1.0, marched.distance_m, 0.0, 0.0));
}

// A pixel has its own ray. Minus the upscale of the texels' own rays, which is in the target, it is
// the error of the upscale; the upscale adds it.
void march_pixel(uint thread)
{
    ivec2 pixel = element_at(int(run.first_ray + thread), view_size().x);
    Ray ray = make_ray(vec2(pixel) + 0.5 + jitter_px, fetch_full(RT_DEPTH, pixel).x, 0.5);
    set_coverage(uvec2(pixel), view_frame);
    MarchedRay marched;
    if (thread >= run.ray_count || !march_ray(thread, ray, marched))
        return;
    put_full(RT_VOLUME, pixel, marched.value - fetch_full(RT_VOLUME, pixel));
}

void main()
{
    load_known_solids();
    uint thread = gl_GlobalInvocationID.x;
    if (ROLE == RT_ROLE_ORDINARY)
        march_tile(thread);
    else if (ROLE == RT_ROLE_ORACLE)
        march_texel(thread);
    else
        march_pixel(thread);
    check_loops();
}

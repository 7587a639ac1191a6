#version 450
// SPDX-License-Identifier: MIT
//
// The march: one ray a tile, through the half-resolution texel that the tile index selected, up to
// its depth; the code is shared with march.comp. A work group has a square of tiles, whose rays
// read the same voxels and diverge late; tiles of a square beyond the view are idle. A dithered
// start (blue noise on the tiles) turns the banding of few steps into noise, which later passes
// filter.
//
// The distance that is stored with a ray is the mean distance of the medium's light along it. A ray
// without such light has the distance of its end, or sky_m where that is the sky: a distance to
// reproject with, at most the largest half.
#extension GL_GOOGLE_include_directive : require

#define SEES_GRID_TEXELS
#define KNOWS_SOLIDS
#define MARCH_STARTS_LATE // behind froxels

#include "renderer/realtime/shared/rays.glsl"

#include "renderer/realtime/shared/dither.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

// With a closed-form transmittance and no light from the media there are no steps to march
// (march.comp).
layout(constant_id = RT_DARK_CONSTANT) const bool IS_DARK = false;

struct Ray {
    ViewRay view;
    vec2 place_px;  // in the frame
    float length_m; // FAR_M: to the sky
    float place;    // of the sample in each step, 0 .. 1
};

Camera camera = frame_camera(); // read before any branch, like the view (shared/view.glsl)

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

Ray make_ray(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + slot_place(int(fetch_tile(RT_TILE, tile).x));
    half_pixel = min(half_pixel, half_size() - 1);
    vec2 place_px = vec2(2 * half_pixel + 1);
    if (choice(RT_JITTERED_DEPTH) != 0)
        place_px += jitter_px;
    float depth_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
    Ray ray;
    ray.place_px = place_px;
    ray.view = camera_ray_at(camera, place_px);
    float cosine = dot(ray.view.direction, camera.forward);
    ray.length_m = depth_m < FAR_M ? depth_m / cosine : FAR_M;
    ray.place = mix(0.5, read_ray_dither(tile, half_pixel), setting(RT_RAY_DITHER_AMOUNT));
    return ray;
}

// view_optical_depth() from the end of the froxels on.
vec3 optical_depth_behind(Ray ray, Sums sums)
{
    ViewRay rest = ViewRay(view_point_m(ray.view, march_from_m), ray.view.direction);
    return IS_SOLVED ? exact_optical_depth(rest.origin_m, rest.direction,
                                           max(ray.length_m - march_from_m, 0.0))
                     : marched_depth(sums);
}

// Mean place at which light is lost in a homogeneous medium, relative to its length:
// (1 / tau) - 1 / (e^tau - 1).
float mean_place(float optical_depth)
{
    float of_one = phi(optical_depth);
    float place = ((1.0 + optical_depth) * of_one - 1.0) / (optical_depth * of_one);
    return optical_depth > 1e-3 ? place : 0.5; // the difference cancels; off by less than 1e-4
}

// Mean distance as for a homogeneous medium along the media's part of the ray.
float dark_distance_m(Ray ray, vec3 optical_depth)
{
    float depth = min(mean(optical_depth), OPAQUE);
    Stretch stretch = scene_stretch(ray.view.origin_m, ray.view.direction, ray.length_m);
    return depth > 0.0 ? mix(stretch.t0_m, stretch.t1_m, mean_place(depth)) : FAR_M;
}

void put_ray(ivec2 tile, vec4 value, float distance_m, float length_m)
{
    float end_m = min(min(length_m, setting(RT_SKY_M)), HALF_MAX);
    put_tile(RT_RAY, tile, value);
    put_tile(RT_RAY_DISTANCE, tile, vec4(min(distance_m, end_m)));
}

void put_dark(ivec2 tile, Ray ray)
{
    vec3 optical_depth = exact_optical_depth(ray.view.origin_m, ray.view.direction, ray.length_m);
    put_ray(tile, vec4(vec3(0.0), fraction_through(optical_depth).x),
            dark_distance_m(ray, optical_depth), ray.length_m);
}

void put_marched(ivec2 tile, Ray ray, Sums sums)
{
    vec3 optical_depth = choice(RT_FROXEL_VOLUME) == 0
                             ? view_optical_depth(ray.view, ray.length_m, sums)
                             : optical_depth_behind(ray, sums);
    put_ray(tile, vec4(view_scattered(sums, optical_depth, ray.view, ray.place_px),
                       fraction_through(optical_depth).x),
            view_distance_m(sums), ray.length_m);
}

void main()
{
    load_known_solids();
    uint thread = gl_GlobalInvocationID.x;
    ivec2 tile = find_ray_tile(int(run.first_ray + thread));
    if (thread >= run.ray_count || any(greaterThanEqual(tile, tile_count())))
        return;
    Ray ray = make_ray(tile);
    if (choice(RT_FROXEL_VOLUME) != 0)
        march_from_m = setting(RT_FROXEL_END_M) / dot(ray.view.direction, camera.forward);
    Sums sums = sums_at_start(thread);
    if (!IS_DARK)
        march(ray.view, ray.length_m, ray.place, sums);
    if (run.end_step < make_nonuniform(frame.steps)) {
        sums_keep(thread, sums);
        return;
    }
    if (IS_DARK)
        put_dark(tile, ray);
    else
        put_marched(tile, ray, sums);
    if (!UNCOUNTED && gl_LocalInvocationIndex == 0u)
        atomicAdd(counters.rays, count_square_rays(tile));
    count_cost();
}

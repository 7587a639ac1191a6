#version 450
// SPDX-License-Identifier: MIT
//
// The temporal gradient: rays are marched again with the same random numbers, and their light is
// compared. The difference has no noise: with a static camera and constant light it is exactly 0.
// After C. Schied, C. Peters, C. Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal
// Filtering", HPG 2018, who march additional rays. Here no ray is added, because the slots of the
// split frame and the jitter repeat with fixed periods:
//
//     frames        0 1 2 3     4 5 6 7     8 9 ..
//     white tiles   sample      compare     sample    A tile marches its four slots in four frames,
//     black tiles   compare     sample      compare   twice in a row with the same ray_dither.
//
// - Medium: white and black are squares of a checkerboard, so every 3x3 tiles have a comparison. A
//   ray is stored under the number of its frame, not of its slot, because an override may march a
//   slot twice in four frames.
// - Behind all media: the jitter repeats after N = taa_jitter_length frames. In each frame every
//   Nth of a tile's 16 pixels, row by row, is compared with its light N frames before. For N = 7
//   the numbers are the frames:
//       0 1 2 3
//       4 5 6 0
//       1 2 3 4
//       5 6 0 1
// - Disocclusion: all texels find by their depth in each frame where the scene behind has changed
//   (reject_depth).
//
// Where the gradient is known to be 0 (RT_STEADY) this pass does not run: the samples behind all
// media stay valid, and the reconstruction stores the rays.
//
// Samples are stored and compared as halves. While the camera moves no ray repeats: the result is
// meaningless then, and the passes that read it check for motion first.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "gradient_samples.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

const int TILE_PX = 16;

// The texel where a pixel's sample is stored. Neighbouring threads read every fourth pixel of a
// row; these are stored side by side: first the pixels of the first column of all tiles, then those
// of the second, and so on.
ivec2 kept_texel(ivec2 pixel)
{
    int in_tile = pixel.x & 3, whole = view_size().x >> 2, rest = view_size().x & 3;
    return ivec2(in_tile * whole + min(in_tile, rest) + (pixel.x >> 2), pixel.y);
}

// Whether the depth of one of the tile's texels differs from the frame before.
bool is_other_scene(ivec2 tile)
{
    if (!is_set(RT_REJECT_DEPTH) || !has_past)
        return is_set(RT_REJECT_DEPTH);
    bool is_other = false; // no early exit, which would wait for each depth
    [[unroll]] for (int i = 0; i < 4; i++) {
        ivec2 half_pixel = 2 * tile + ivec2(i & 1, i >> 1);
        float now_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
        float before_m = fetch_half(RT_HALF_DEPTH_BEFORE, half_pixel).x;
        precise float difference_m = abs(now_m - before_m);
        precise float allowed_m = setting(RT_REJECT_DEPTH) * now_m;
        is_other = is_other || (now_m != before_m && !(difference_m < allowed_m));
    }
    return is_other;
}

// In the first frame (memory has arbitrary contents) and after a cut there are no earlier samples.
void clear_samples(ivec2 tile)
{
    for (int i = 0; i < 4; i++) {
        ivec2 half_pixel = 2 * tile + ivec2(i & 1, i >> 1);
        if (half_pixel.x < half_size().x && half_pixel.y < half_size().y)
            put_half(RT_KEPT_RAY, half_pixel, vec4(0.0));
    }
    for (int i = 0; i < TILE_PX; i++) {
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        if (pixel.x < view_size().x && pixel.y < view_size().y)
            put_full(RT_KEPT_BEHIND, kept_texel(pixel), vec4(0.0));
    }
}

void sample_medium(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + kept_place();
    vec4 now = vec4(0.0), then = vec4(0.0);
    bool is_known = half_pixel.x < half_size().x && half_pixel.y < half_size().y;
    if (is_known) { // a partial tile has less than four texels
        now = as_halves(fetch_tile(RT_RAY, tile));
        then = limit_to_half(fetch_half(RT_KEPT_RAY, half_pixel)); // NaN becomes 0
        put_half(RT_KEPT_RAY, half_pixel, now);
    }
    is_known = is_known && repeats_ray(tile);
    precise float of_transmittance = abs(now.a - then.a);
    float largest_residue = is_other_scene(tile) ? 1.0 : is_known ? of_transmittance : 0.0;
    put_tile(RT_SAMPLE_NOW, tile, vec4(now.rgb, largest_residue));
    put_tile(RT_SAMPLE_THEN, tile, vec4(then.rgb, is_known ? 1.0 : 0.0));
}

// Number of pixels per step, every Nth of a tile: one step is enough for a jitter of 6 places or
// more.
const int AT_ONCE = 3;

// Decided when the shader is compiled: lavapipe executes a loop once even where no thread needs it.
bool can_residue_grow()
{
    return !SPECIALISED || AT_ONCE * known_choice(RT_TAA_JITTER_LENGTH) < TILE_PX;
}

struct Samples {
    ivec2 pixels[AT_ONCE];
    bool are_there[AT_ONCE];
    vec3 now[AT_ONCE], then[AT_ONCE];
};

Samples load_samples(ivec2 tile, int first, int step)
{
    Samples samples;
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        int i = first + k * step;
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        samples.pixels[k] = pixel;
        samples.are_there[k] = i < TILE_PX && pixel.x < view_size().x && pixel.y < view_size().y;
        samples.now[k] = as_halves(fetch_full(RT_BEHIND, pixel)).rgb;
        samples.then[k] = limit_to_half(fetch_full(RT_KEPT_BEHIND, kept_texel(pixel))).rgb;
    }
    return samples;
}

struct Sums {
    vec3 now, then;
    int count;
};

void add(Samples samples, inout Sums sums)
{
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        precise vec3 now = sums.now + samples.now[k], then = sums.then + samples.then[k];
        if (samples.are_there[k])
            sums = Sums(now, then, sums.count + 1);
    }
}

// Stores samples for the next comparison. `unlike` becomes the maximum of itself and the residue of
// each sample after their common gain.
void keep_samples(Samples samples, vec3 gain, inout float largest_residue)
{
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        if (!samples.are_there[k])
            continue;
        float residue = residue_between(samples.now[k], samples.then[k], gain);
        largest_residue = residue > largest_residue ? residue : largest_residue;
        put_full(RT_KEPT_BEHIND, kept_texel(samples.pixels[k]), vec4(samples.now[k], 0.0));
    }
}

// Where the gain of one of a tile's pixels differs from the others there is the edge of a shadow.
void sample_behind(ivec2 tile)
{
    int step = int(setting(RT_TAA_JITTER_LENGTH)), first = int(view_frame % uint(step));
    Samples samples = load_samples(tile, first, step);
    Sums sums = Sums(vec3(0.0), vec3(0.0), 0);
    add(samples, sums);
    for (int i = first + AT_ONCE * step; can_residue_grow() && i < TILE_PX; i += AT_ONCE * step)
        add(load_samples(tile, i, step), sums);
    vec3 gain = gain_between(sums.now, sums.then);
    float largest_residue = 0.0;
    keep_samples(samples, gain, largest_residue);
    for (int i = first + AT_ONCE * step; can_residue_grow() && i < TILE_PX; i += AT_ONCE * step)
        keep_samples(load_samples(tile, i, step), gain, largest_residue);
    put_tile(RT_SAMPLE_BEHIND_NOW, tile, vec4(sums.now, largest_residue));
    put_tile(RT_SAMPLE_BEHIND_THEN, tile, vec4(sums.then, float(sums.count)));
}

void main()
{
    ivec2 tile;
    if (!find_element(tile_count(), tile))
        return;
    if (!has_past)
        clear_samples(tile);
    sample_medium(tile);
    sample_behind(tile);
}

#version 450
// SPDX-License-Identifier: MIT
//
// The temporal gradient: what the same rays see that were marched before. The same, down to the
// random number that shifts their start: noise has no part in the difference, and before a camera
// at rest and in steady light it is 0 to the last bit. After C. Schied, C. Peters, C. Dachsbacher,
// "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018, who march such rays
// besides the others; here the others do it, since the split of the frame and the jitter come back
// by themselves:
//
// - A tile chooses its slots alike every four frames, and marches them with the same numbers of
//   ray_dither twice in a row (gradient = on). In each four frames one half of the tiles, those of
//   one colour of a checkerboard, repeat what they did in the four before, so every 3x3 tiles know.
//   A ray is kept under the number of its frame, not of its slot, which an override may march twice
//   in four frames.
// - The jitter repeats after taa_jitter_length frames, N. In each frame every Nth pixel of a tile
//   looks at what is behind all media, and compares it with what it saw N frames before.
// - What a solid has uncovered or hidden since the frame before all texels see at once, by their
//   depth (reject_depth): it is not as it was, whatever light does.
//
// What is kept is of halves and compared as such. When the camera moves, no ray is the same one:
// what comes out then is of no use, and the consumers go by motion before they ask.
#extension GL_GOOGLE_include_directive : require

#include "realtime_looks.glsl"
#include "realtime_pass.glsl"
#include "realtime_slots.glsl"

const int TILE_PX = 16;

// What a half keeps of a value; not more than the largest. A NaN becomes 0.
float kept(float value)
{
    return value > 0.0 ? from_half(to_half(value < HALF_MAX ? value : HALF_MAX)) : 0.0;
}

vec4 kept(vec4 value)
{
    return vec4(kept(value.r), kept(value.g), kept(value.b), kept(value.a));
}

// Whether the scene behind one of the tile's texels is another one than in the frame before.
bool is_other_scene(ivec2 tile)
{
    if (!is_set(RT_REJECT_DEPTH) || !has_past)
        return is_set(RT_REJECT_DEPTH);
    for (int i = 0; i < 4; i++) {
        ivec2 half_pixel = 2 * tile + ivec2(i & 1, i >> 1);
        float now_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
        float before_m = fetch_half(RT_HALF_DEPTH_BEFORE, half_pixel).x;
        precise float difference_m = abs(now_m - before_m);
        precise float allowed_m = setting(RT_REJECT_DEPTH) * now_m;
        if (now_m != before_m && !(difference_m < allowed_m))
            return true;
    }
    return false;
}

// Nothing was seen before a first picture, whatever lies in memory, nor before a cut.
void forget(ivec2 tile)
{
    for (int i = 0; i < 4; i++) {
        ivec2 half_pixel = 2 * tile + ivec2(i & 1, i >> 1);
        if (half_pixel.x < half_size().x && half_pixel.y < half_size().y)
            put_half(RT_KEPT_RAY, half_pixel, vec4(0.0));
    }
    for (int i = 0; i < TILE_PX; i++) {
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        if (pixel.x < view_size().x && pixel.y < view_size().y)
            put_full(RT_KEPT_BEHIND, pixel, vec4(0.0));
    }
}

void look_at_medium(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + ivec2(view_frame & 1u, view_frame >> 1 & 1u);
    vec4 now = vec4(0.0), then = vec4(0.0);
    bool is_known = half_pixel.x < half_size().x && half_pixel.y < half_size().y;
    if (is_known) { // a cut tile has no room for all four
        now = kept(fetch_tile(RT_RAY, tile));
        then = kept(fetch_half(RT_KEPT_RAY, half_pixel)); // what is no number is 0
        put_half(RT_KEPT_RAY, half_pixel, now);
    }
    is_known = is_known && repeats_ray(tile);
    precise float of_transmittance = abs(now.a - then.a);
    float unlike = is_other_scene(tile) ? 1.0 : is_known ? of_transmittance : 0.0;
    put_tile(RT_LOOK_NOW, tile, vec4(now.rgb, unlike));
    put_tile(RT_LOOK_THEN, tile, vec4(then.rgb, is_known ? 1.0 : 0.0));
}

// Light that has another gain in one of a tile's pixels than in the others is a shadow's edge.
void look_behind(ivec2 tile)
{
    int length = int(setting(RT_TAA_JITTER_LENGTH)), count = 0;
    vec3 now[TILE_PX], then[TILE_PX];
    precise vec3 sum_now = vec3(0.0), sum_then = vec3(0.0);
    for (int i = int(view_frame % uint(length)); i < TILE_PX; i += length) {
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        if (pixel.x >= view_size().x || pixel.y >= view_size().y)
            continue;
        now[count] = kept(fetch_full(RT_BEHIND, pixel)).rgb;
        then[count] = kept(fetch_full(RT_KEPT_BEHIND, pixel)).rgb;
        put_full(RT_KEPT_BEHIND, pixel, vec4(now[count], 0.0));
        sum_now += now[count];
        sum_then += then[count];
        count++;
    }
    vec3 gain = gain_between(sum_now, sum_then);
    float unlike = 0.0;
    for (int i = 0; i < count; i++) {
        float residue = residue_between(now[i], then[i], gain);
        unlike = residue > unlike ? residue : unlike;
    }
    put_tile(RT_LOOK_BEHIND_NOW, tile, vec4(sum_now, unlike));
    put_tile(RT_LOOK_BEHIND_THEN, tile, vec4(sum_then, float(count)));
}

void main()
{
    ivec2 tile;
    if (!own_element(tile_count(), tile))
        return;
    if (!has_past)
        forget(tile);
    look_at_medium(tile);
    look_behind(tile);
}

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
// Where it is known that nothing has changed for long (steady) it does not run: what was kept
// behind all media is what is there now, and the reconstruction keeps the rays.
//
// What is kept is of halves and compared as such. When the camera moves, no ray is the same one:
// what comes out then is of no use, and the consumers go by motion before they ask.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "gradient_samples.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

const int TILE_PX = 16;

// Where a pixel is kept. Threads that follow each other look at every fourth pixel of a row: those
// lie side by side, all of a place in the tile before those of the next, so that what memory gives
// at once is of use.
ivec2 kept_pixel(ivec2 pixel)
{
    int in_tile = pixel.x & 3, whole = view_size().x >> 2, rest = view_size().x & 3;
    return ivec2(in_tile * whole + min(in_tile, rest) + (pixel.x >> 2), pixel.y);
}

// Whether the scene behind one of the tile's texels is another one than in the frame before.
bool is_other_scene(ivec2 tile)
{
    if (!is_set(RT_REJECT_DEPTH) || !has_past)
        return is_set(RT_REJECT_DEPTH);
    bool is_other = false; // a loop with a way out would wait for each depth
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
            put_full(RT_KEPT_BEHIND, kept_pixel(pixel), vec4(0.0));
    }
}

void look_at_medium(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + kept_place();
    vec4 now = vec4(0.0), then = vec4(0.0);
    bool is_known = half_pixel.x < half_size().x && half_pixel.y < half_size().y;
    if (is_known) { // a cut tile has no room for all four
        now = kept(fetch_tile(RT_RAY, tile));
        then = limited(fetch_half(RT_KEPT_RAY, half_pixel)); // what is no number is 0
        put_half(RT_KEPT_RAY, half_pixel, now);
    }
    is_known = is_known && repeats_ray(tile);
    precise float of_transmittance = abs(now.a - then.a);
    float unlike = is_other_scene(tile) ? 1.0 : is_known ? of_transmittance : 0.0;
    put_tile(RT_LOOK_NOW, tile, vec4(now.rgb, unlike));
    put_tile(RT_LOOK_THEN, tile, vec4(then.rgb, is_known ? 1.0 : 0.0));
}

// Some of a tile's pixels, every Nth: as many as there are with a jitter of 6 places or more.
const int AT_ONCE = 3;

// Known before, since lavapipe runs a loop once even if nobody wants it.
bool may_be_more()
{
    return !SPECIALISED || AT_ONCE * known_choice(RT_TAA_JITTER_LENGTH) < TILE_PX;
}

struct Looks {
    ivec2 pixels[AT_ONCE];
    bool are_there[AT_ONCE];
    vec3 now[AT_ONCE], then[AT_ONCE];
};

Looks look_from(ivec2 tile, int first, int step)
{
    Looks looks;
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        int i = first + k * step;
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        looks.pixels[k] = pixel;
        looks.are_there[k] = i < TILE_PX && pixel.x < view_size().x && pixel.y < view_size().y;
        looks.now[k] = kept(fetch_full(RT_BEHIND, pixel)).rgb;
        looks.then[k] = limited(fetch_full(RT_KEPT_BEHIND, kept_pixel(pixel))).rgb;
    }
    return looks;
}

struct Sums {
    vec3 now, then;
    int count;
};

void add(Looks looks, inout Sums sums)
{
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        precise vec3 now = sums.now + looks.now[k], then = sums.then + looks.then[k];
        if (looks.are_there[k])
            sums = Sums(now, then, sums.count + 1);
    }
}

// What their common gain leaves unexplained in one of them. They are kept for the next time.
void remember(Looks looks, vec3 gain, inout float unlike)
{
    [[unroll]] for (int k = 0; k < AT_ONCE; k++) {
        if (!looks.are_there[k])
            continue;
        float residue = residue_between(looks.now[k], looks.then[k], gain);
        unlike = residue > unlike ? residue : unlike;
        put_full(RT_KEPT_BEHIND, kept_pixel(looks.pixels[k]), vec4(looks.now[k], 0.0));
    }
}

// Light that has another gain in one of a tile's pixels than in the others is a shadow's edge.
void look_behind(ivec2 tile)
{
    int step = int(setting(RT_TAA_JITTER_LENGTH)), first = int(view_frame % uint(step));
    Looks looks = look_from(tile, first, step);
    Sums sums = Sums(vec3(0.0), vec3(0.0), 0);
    add(looks, sums);
    for (int i = first + AT_ONCE * step; may_be_more() && i < TILE_PX; i += AT_ONCE * step)
        add(look_from(tile, i, step), sums);
    vec3 gain = gain_between(sums.now, sums.then);
    float unlike = 0.0;
    remember(looks, gain, unlike);
    for (int i = first + AT_ONCE * step; may_be_more() && i < TILE_PX; i += AT_ONCE * step)
        remember(look_from(tile, i, step), gain, unlike);
    put_tile(RT_LOOK_BEHIND_NOW, tile, vec4(sums.now, unlike));
    put_tile(RT_LOOK_BEHIND_THEN, tile, vec4(sums.then, float(sums.count)));
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

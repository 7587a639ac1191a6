#version 450
// SPDX-License-Identifier: MIT
//
// The temporal gradient: what has changed since the same rays were marched before. The same, down
// to the random number that shifts their start: noise has no part in the difference, and before a
// camera at rest and in steady light it is 0 to the last bit. After C. Schied, C. Peters, C.
// Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018, who march
// such rays besides the others; here the others do it, since the split of the frame and the jitter
// come back by themselves:
//
// - A tile chooses its slots alike every four frames, and marches them with the same numbers of
//   ray_dither twice in a row (gradient = on). In each four frames one half of the tiles, those of
//   one colour of a checkerboard, repeat what they did in the four before, so every 3x3 tiles know.
//   A ray is kept under the number of its frame, not of its slot, which an override may march twice
//   in four frames.
// - The jitter repeats after taa_jitter_length frames, N. In each frame every Nth pixel of a tile
//   looks at what is behind all media, and compares it with what it saw N frames before.
//
// What changed is a luminance, relative to the larger one, or a transmittance. What is kept is of
// halves and compared as such. When the camera moves, no ray is the same one: what comes out then
// is of no use, and the consumers go by motion before they ask.
#extension GL_GOOGLE_include_directive : require

#include "realtime_pass.glsl"
#include "realtime_slots.glsl"

const int TILE_PX = 16;

// What a half keeps of a value; not more than the largest. A NaN becomes 0.
float kept(float value)
{
    return value > 0.0 ? from_half(to_half(value < HALF_MAX ? value : HALF_MAX)) : 0.0;
}

float kept_luminance(vec3 color)
{
    precise float sum = 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
    return kept(sum);
}

float relative_change(float now, float then)
{
    precise float difference = abs(now - then);
    float most = now > then ? now : then;
    precise float part = difference / most;
    return most > 0.0 ? part : 0.0;
}

float change_of_ray(ivec2 tile)
{
    ivec2 half_pixel = 2 * tile + ivec2(view_frame & 1u, view_frame >> 1 & 1u);
    if (half_pixel.x >= half_size().x || half_pixel.y >= half_size().y)
        return -1.0; // a cut tile has no room for all four
    vec4 ray = fetch_tile(RT_RAY, tile);
    vec2 now = vec2(kept_luminance(ray.rgb), kept(ray.a));
    vec2 found = fetch_half(RT_KEPT_RAY, half_pixel).xy;
    vec2 then = vec2(kept(found.x), kept(found.y)); // what was kept stays; what is no number is 0
    put_half(RT_KEPT_RAY, half_pixel, vec4(now, 0.0, 0.0));
    precise float of_transmittance = abs(now.y - then.y);
    float of_luminance = relative_change(now.x, then.x);
    if (!repeats_ray(tile))
        return -1.0;
    return of_luminance > of_transmittance ? of_luminance : of_transmittance;
}

float change_behind(ivec2 tile)
{
    int length = int(setting(RT_TAA_JITTER_LENGTH));
    float most = 0.0;
    for (int i = int(view_frame % uint(length)); i < TILE_PX; i += length) {
        ivec2 pixel = 4 * tile + ivec2(i & 3, i >> 2);
        if (pixel.x >= view_size().x || pixel.y >= view_size().y)
            continue;
        float now = kept_luminance(fetch_full(RT_BEHIND, pixel).rgb);
        float change = relative_change(now, kept(fetch_full(RT_KEPT_BEHIND, pixel).x));
        put_full(RT_KEPT_BEHIND, pixel, vec4(now, 0.0, 0.0, 0.0));
        most = change > most ? change : most;
    }
    return most;
}

void main()
{
    ivec2 tile;
    if (!own_element(tile_count(), tile))
        return;
    put_tile(RT_CHANGE, tile, vec4(change_of_ray(tile), change_behind(tile), 0.0, 0.0));
}

// SPDX-License-Identifier: MIT
//
// The depth map at half resolution. One texel stands for 2x2 pixels by one of their eye depths: on
// the checkerboard's white squares (x % 2 == y % 2) the nearest, on the black ones the farthest, so
// that 2x2 texels, a tile, know two near and two far depths of their 4x4 pixels.
// "Nearest" and "farthest" are meant in distance: in a reversed depth buffer the names swap. The
// article takes the minimum of such a buffer, the farthest, on the white squares: `reversed`.
#ifndef NEPH_REALTIME_DEPTH_MAP_GLSL
#define NEPH_REALTIME_DEPTH_MAP_GLSL

#include "renderer/realtime/shared/view.glsl"

// All four depths on their way at once; held at the far sides alone, which odd sizes have no
// second pixel at.
float mapped_at_once_m(ivec2 half_pixel, bool nearest)
{
    ivec2 first = view_origin() + 2 * half_pixel;
    ivec2 second = min(first + 1, view_origin() + view_size() - 1);
    float a_m = fetch(RT_STEADY_DEPTH, first).x, b_m = fetch(RT_STEADY_DEPTH, second).x;
    float c_m = fetch(RT_STEADY_DEPTH, ivec2(second.x, first.y)).x;
    float d_m = fetch(RT_STEADY_DEPTH, ivec2(first.x, second.y)).x;
    return nearest ? min(min(a_m, b_m), min(c_m, d_m)) : max(max(a_m, b_m), max(c_m, d_m));
}

// The depth of a texel of the view [m].
float mapped_depth_m(ivec2 half_pixel)
{
    bool is_white = (half_pixel.x & 1) == (half_pixel.y & 1);
    bool nearest = choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_NEAREST ||
                   (choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_CHECKERBOARD && is_white) ||
                   (choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_REVERSED && !is_white);
    if (ON_GPU)
        return mapped_at_once_m(half_pixel, nearest);
    float chosen_m = fetch_full(RT_STEADY_DEPTH, 2 * half_pixel).x;
    for (int i = 1; i < 4; i++) {
        float depth_m = fetch_full(RT_STEADY_DEPTH, 2 * half_pixel + ivec2(i & 1, i >> 1)).x;
        if (nearest ? depth_m < chosen_m : depth_m > chosen_m)
            chosen_m = depth_m;
    }
    return chosen_m;
}

#endif

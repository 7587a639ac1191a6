// SPDX-License-Identifier: MIT
//
// The depth map at half resolution. One texel represents 2x2 pixels by one of their eye depths: on
// the checkerboard's white squares (x % 2 == y % 2) the nearest, on the black ones the farthest:
//
//     n f n f     n  nearest of 2x2 pixels
//     f n f n     f  farthest
//
// So 2x2 texels, a tile, have two near and two far depths of their 4x4 pixels. "Nearest" and
// "farthest" are distances: in a reversed depth buffer the comparisons swap. The article takes the
// minimum of such a buffer, the farthest, on the white squares: `reversed`.
#ifndef NEPH_REALTIME_DEPTH_MAP_GLSL
#define NEPH_REALTIME_DEPTH_MAP_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/shared/view.glsl"

// The depth of a half-resolution texel of the view [m]. All four pixels are read before the first
// comparison.
float mapped_depth_m(ivec2 half_pixel)
{
    bool is_white = (half_pixel.x & 1) == (half_pixel.y & 1);
    bool takes_nearest = choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_NEAREST ||
                         (choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_CHECKERBOARD && is_white) ||
                         (choice(RT_DEPTH_MAP) == RT_DEPTH_MAP_REVERSED && !is_white);
    float depths_m[4];
    [[unroll]] for (int i = 0; i < 4; i++)
        depths_m[i] = fetch_full(RT_STEADY_DEPTH, 2 * half_pixel + ivec2(i & 1, i >> 1)).x;
    float chosen_m = depths_m[0];
    [[unroll]] for (int i = 1; i < 4; i++)
        if (takes_nearest ? depths_m[i] < chosen_m : depths_m[i] > chosen_m)
            chosen_m = depths_m[i];
    return chosen_m;
}

#endif

#version 450
// SPDX-License-Identifier: MIT
//
// The depth map (realtime_depth_map.glsl), a thread for each texel. On a GPU the tile index can
// make it by itself (rt_tile_index.comp).
#extension GL_GOOGLE_include_directive : require

#include "realtime_depth_map.glsl"
#include "realtime_pass.glsl"

void main()
{
    ivec2 element;
    if (!own_element(half_size(), element))
        return;
    put_half(RT_HALF_DEPTH, element, vec4(mapped_depth_m(element)));
}

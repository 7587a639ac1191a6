#version 450
// SPDX-License-Identifier: MIT
//
// The depth map (depth_map.glsl), one thread a texel. On a GPU the tile index can write it
// (realtime/tile_index/tile_index.comp).
#extension GL_GOOGLE_include_directive : require

#include "depth_map.glsl"
#include "renderer/realtime/shared/pass.glsl"

void main()
{
    ivec2 element;
    if (!find_element(half_size(), element))
        return;
    put_half(RT_HALF_DEPTH, element, vec4(mapped_depth_m(element)));
}

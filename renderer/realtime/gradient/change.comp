#version 450
// SPDX-License-Identifier: MIT
//
// The change around a tile (change_samples.glsl), one thread a tile. On a GPU the reconstruction
// computes it in place of this pass (realtime/reconstruction/reconstruct_gpu.comp).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "change_around.glsl"
#include "renderer/realtime/shared/pass.glsl"

vec4 load_sample(int target, ivec2 tile) { return fetch_tile(target, tile); }

void main()
{
    ivec2 tile;
    if (!find_element(tile_count(), tile))
        return;
    put_tile(RT_CHANGE, tile, compute_medium_change(tile));
    put_tile(RT_CHANGE_BEHIND, tile, change_behind(tile));
}

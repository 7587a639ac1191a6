#version 450
// SPDX-License-Identifier: MIT
//
// Composes the froxels with the marched volume: from the four columns around a pixel the medium in
// front of its depth, with a part of the last froxel, and behind it the march, which starts at the
// far end of the froxels.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"

#include "froxels.glsl"

void main()
{
    ivec2 pixel;
    if (!find_element(view_size(), pixel))
        return;
    vec2 place_px = vec2(pixel) + 0.5 + jitter_px;
    float depth_m = fetch_full(RT_DEPTH, pixel).x;
    float clipped_depth_m = depth_m < froxel_end_m() ? depth_m : froxel_end_m();
    float slope = 1.0 / dot(view_line_at(view_now, place_px).direction, view_now.forward);
    vec4 before = froxels_before(place_px, clipped_depth_m, slope);
    put_full(RT_VOLUME, pixel, froxel_over(before, fetch_full(RT_VOLUME, pixel)));
}

#version 450
// SPDX-License-Identifier: MIT
//
// The froxels before the marched volume: of the four columns around a pixel what lies before its
// depth, the last froxel in part, and behind them what the march found from the volume's end on.
#extension GL_GOOGLE_include_directive : require

#include "realtime_pass.glsl"

#include "froxels.glsl"

vec4 column_before(ivec2 column, int slice, float length_m)
{
    vec4 before = vec4(0.0, 0.0, 0.0, 1.0);
    if (slice > 0)
        before = fetch_froxel(FROXEL_SUMS, ivec3(column, slice - 1));
    vec4 last = fetch_froxel(froxel_section_now(), ivec3(column, slice));
    return froxel_over(before, froxel_stretch(last, length_m));
}

void main()
{
    ivec2 pixel;
    if (!own_element(view_size(), pixel))
        return;
    vec2 place_px = vec2(pixel) + 0.5 + jitter_px;
    float depth_m = fetch_full(RT_DEPTH, pixel).x;
    float seen_m = depth_m < froxel_end_m() ? depth_m : froxel_end_m();
    float slope = 1.0 / dot(view_line_at(view_now, place_px).direction, view_now.forward);
    int slice = clamp(int(froxel_place(seen_m)), 0, froxel_count.z - 1);
    float length_m = max(seen_m - froxel_edge_m(slice), 0.0) * slope;
    vec2 place = place_px / float(froxel_px) - 0.5;
    vec2 low = floor(place), part = place - low;
    vec4 before = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 step = ivec2(i & 1, i >> 1);
        vec2 weight = mix(1.0 - part, part, vec2(step));
        before += weight.x * weight.y * column_before(ivec2(low) + step, slice, length_m);
    }
    put_full(RT_VOLUME, pixel, froxel_over(before, fetch_full(RT_VOLUME, pixel)));
}

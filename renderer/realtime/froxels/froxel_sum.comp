#version 450
// SPDX-License-Identifier: MIT
// Sums a column front to back: in-scattered radiance and transmittance in front of the far edge of
// each slice. Each froxel is integrated along its length (froxels.glsl), which conserves energy for
// any optical depth.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"

#include "froxels.glsl"

void main()
{
    ivec2 column;
    if (!find_element(froxel_count.xy, column))
        return;
    vec2 place_px = (vec2(column) + 0.5) * float(froxel_px);
    float slope = 1.0 / dot(view_line_at(view_now, place_px).direction, view_now.forward);
    vec4 sum = vec4(0.0, 0.0, 0.0, 1.0);
    for (int slice = 0; slice < froxel_count.z; slice++) {
        ivec3 froxel = ivec3(column, slice);
        float length_m = (froxel_edge_m(slice + 1) - froxel_edge_m(slice)) * slope;
        vec4 scattered = fetch_froxel(froxel_section_now(), froxel);
        sum = froxel_over(sum, froxel_stretch(scattered, length_m));
        put(RT_FROXELS, froxel_texel(FROXEL_SUMS, froxel), sum);
    }
}

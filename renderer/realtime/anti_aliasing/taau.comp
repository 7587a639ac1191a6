#version 450
// SPDX-License-Identifier: MIT
//
// Temporal upsampling as in Unreal Engine 4.26: the history has the pixels of the picture, the
// frame has fewer. A pixel's source is the rendered pixel whose jittered ray went nearest to its
// centre, and the nine around that are filtered by their distance, in pixels of the picture. So
// few rays go by the centre in a frame: where none did the frame weighs less, by the sum of the
// filter.
//
// Done differently: the filter is the Gaussian of taa.comp, which is nowhere 0 / 0; Unreal has a
// polynomial of d^2 that ends at one pixel. Else as in taa.comp, with what that does
// differently.
#extension GL_GOOGLE_include_directive : require

#include "taa.glsl"

// Where the pixel is in the frame, and which of its rays went nearest.
ivec2 find_source(ivec2 pixel)
{
    precise vec2 way_px = (vec2(pixel) + 0.5) * rendered_per_px - jitter_px;
    precise vec2 nearest = floor(way_px);
    precise vec2 shift = nearest + 0.5 - way_px;
    shift_px = shift;
    return ivec2(nearest);
}

void find_weights()
{
    coverage = 0.0;
    for (int i = 0; i < 9; i++) {
        vec2 way = (vec2(offset_of(i)) + shift_px) / rendered_per_px;
        nearness[i] = exp(-SHARPNESS * dot(way, way));
        coverage += nearness[i];
    }
    coverage = min(coverage, 1.0);
}

// 1.51 px, 1.3 at half the size.
void find_reach()
{
    precise float times = 1.0 / rendered_per_px.x;
    precise float reach = 1.51 - 0.21 * (times - 1.0);
    box_reach_squared = reach * reach;
}

void main()
{
    ivec2 pixel;
    if (!own_element(picture_size(), pixel))
        return;
    ivec2 source = find_source(pixel);
    find_weights();
    find_reach();
    if (asks_for_change())
        find_change(clamp(source, ivec2(0), view_size() - 1) / 4);
    is_at_rest = rests();
    vec4 made = resolved(pixel, source, film_of(look_around(source)));
    put_picture(RT_TAA_OUT, pixel, vec4(round_to_format(made.rgb, pixel), made.a));
}

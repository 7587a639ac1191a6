#version 450
// SPDX-License-Identifier: MIT
//
// Temporal upsampling as in Unreal Engine 4.26: the anti-aliasing of taa.comp with more output
// pixels than rendered pixels (upsampling.glsl). Different from Unreal: the filter is the Gaussian
// of the anti-aliasing, which is nowhere 0 / 0; Unreal has a polynomial of d^2 that ends at one
// pixel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"
#include "rounding.glsl"
#include "taa.glsl"
#include "upsampling.glsl"

// 1.51 px at full size, 1.3 px at half size.
float near_px_squared()
{
    precise float times = 1.0 / rendered_per_px.x;
    precise float near_px = 1.51 - 0.21 * (times - 1.0);
    return near_px * near_px;
}

void main()
{
    ivec2 pixel;
    if (!find_element(get_output_size(), pixel))
        return;
    ivec2 source = find_source(pixel);
    find_change(source_tile(source));
    find_filter_weights_and_coverage();
    box_distance_squared = near_px_squared();
    Frame frame = frame_from(fetch_neighbourhood(source), !is_unclamped);
    put_pixel(pixel, resolve(pixel, source, find_past(pixel, source), frame));
}

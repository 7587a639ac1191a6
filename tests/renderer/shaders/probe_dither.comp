#version 450
// SPDX-License-Identifier: MIT
//
// Probe of the dither, for renderer/realtime/shared/check_dither.c: kind ray_dither in each of four
// channels, at the view's frame; the first pixel is (-70, -5).
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/dither.glsl"
#include "renderer/realtime/shared/pass.glsl"

void main()
{
    ivec2 pixel;
    if (!find_element(view_size(), pixel))
        return;
    ivec2 place = pixel - ivec2(70, 5);
    vec4 numbers;
    for (int channel = 0; channel < 4; channel++)
        numbers[channel] = dither(choice(RT_RAY_DITHER), place, view.frame, uint(channel));
    put_full(RT_COLOR, pixel, numbers);
}

#version 450
// SPDX-License-Identifier: MIT
//
// The picture: direct light, and of the sky's what the open share of the hemisphere lets through.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

float open_at(ivec2 pixel)
{
    if (choice(SCREEN_AO) == SCREEN_AO_OFF)
        return 1.0;
    return choice(SCREEN_AO_BLUR_PX) != 0 ? load(SCREEN_OPEN_SMOOTH, pixel).x
                                          : load(SCREEN_OPEN, pixel).x;
}

void main()
{
    ivec2 pixel;
    if (!own_pixel(pixel))
        return;
    vec3 picture = load(SCREEN_DIRECT, pixel).rgb;
    if (!is_sky(depth_at_m(pixel)))
        picture += load(SCREEN_BASE, pixel).rgb * sky_light() * open_at(pixel);
    store(SCREEN_PICTURE, pixel, vec4(picture, 1.0));
}

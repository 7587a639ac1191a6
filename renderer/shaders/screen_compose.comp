#version 450
// SPDX-License-Identifier: MIT
//
// Composes the image, in two turns. Turn 0 adds direct and diffuse light; reflections read its
// result. Turn 1 adds the reflections. Without ray-traced indirect light the sky illuminates
// surfaces by their unoccluded fraction.
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

// Indirect light reflected by a white surface.
vec3 indirect(uint target, ivec2 pixel)
{
    float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
    vec4 light = target != SCREEN_NONE ? load(int(target), pixel) : vec4(0.0, 0.0, 0.0, open);
    return light.rgb + light.w * sky_light();
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    bool is_last = run.turn == 1u, is_solid = !is_sky(depth_at_m(pixel));
    vec3 light = load(is_last ? SCREEN_LIT : SCREEN_DIRECT, pixel).rgb;
    vec4 base = load(SCREEN_BASE, pixel);
    if (is_solid)
        light += is_last ? base.rgb * base.w * indirect(view.ssr_at, pixel)
                         : base.rgb * (1.0 - base.w) * indirect(view.gi_at, pixel);
    store(is_last ? SCREEN_PICTURE : SCREEN_LIT, pixel, vec4(light, 1.0));
}

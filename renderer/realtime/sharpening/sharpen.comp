#version 450
// SPDX-License-Identifier: MIT
//
// Sharpening of the finished frame, against the blur of anti-aliasing. The difference between a
// pixel and the mean of its four neighbours is increased by half, and the result is clamped to the
// range of the five pixels:
//
//       n         result = clamp(p + AMOUNT (p - mean(n)), min, max of p and n)
//     n p n
//       n
//
// So edges do not ring, a constant stays constant, and no radiance becomes negative (unsharp
// masking limited as in AMD's Robust Contrast Adaptive Sharpening).
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"

const float AMOUNT = 0.5; // of the difference from the mean of four

const ivec2 CROSS[4] = {ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1)};

vec3 load_pixel(ivec2 pixel)
{
    return choice(RT_TAA) != RT_TAA_OFF ? fetch_output(RT_TAA_OUT, pixel).rgb
                                        : fetch_full(RT_COLOR, pixel).rgb;
}

void main()
{
    ivec2 pixel;
    if (!find_element(get_output_size(), pixel))
        return;
    vec3 center = load_pixel(pixel), least = center, largest = center, sum = vec3(0.0);
    for (int i = 0; i < 4; i++) {
        vec3 neighbour = load_pixel(pixel + CROSS[i]);
        least = mix(least, neighbour, lessThan(neighbour, least));
        largest = mix(largest, neighbour, greaterThan(neighbour, largest));
        sum += neighbour;
    }
    precise vec3 sharper = center + AMOUNT * (center - 0.25 * sum);
    sharper = mix(sharper, least, lessThan(sharper, least));
    sharper = mix(sharper, largest, greaterThan(sharper, largest));
    put_output(RT_SHARPENED, pixel, vec4(sharper, 0.0));
}

#version 450
// SPDX-License-Identifier: MIT
//
// The upscale (upscale.comp) for a GPU and targets in half precision. The mean is not clamped to
// the range of its values: a float32 sum is off by less than half a step of the halves that it is
// rounded to.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"
#include "upscale.glsl"

vec4 weighted_mean(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total)
{
    vec4 sum = vec4(0.0);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        sum += weights[i] * taps[i].volume;
    return sum / total;
}

void main()
{
    ivec2 quad;
    if (find_element(view_size() / 2 + 1, quad))
        upscale(quad);
}

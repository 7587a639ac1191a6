#version 450
// SPDX-License-Identifier: MIT
//
// Adaptive sharpening of values in 0..1: a pixel minus w times its four neighbours, over 1 - 4 w.
// The weight w adapts to the headroom of the neighbourhood:
//
//   cas   contrast-adaptive sharpening (AMD FidelityFX CAS, 2019): w follows the distance of the
//         neighbourhood's extremes to 0 and 1; the extremes of the four neighbours and of all
//         nine pixels are averaged
//   rcas  robust contrast-adaptive sharpening (AMD FSR 1, 2021): w is the largest weight that keeps
//         the result in 0..1, at most 3/16, times the amount
//
//     0 1 2
//     3 4 5      indices of around[]
//     6 7 8
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "post.glsl"

vec3 cas(vec3 around[9])
{
    vec3 least = around[4], most = around[4];
    [[unroll]] for (int i = 1; i < 9; i += 2) {
        least = min(least, around[i]);
        most = max(most, around[i]);
    }
    vec3 least_of_all = least, most_of_all = most;
    [[unroll]] for (int i = 0; i < 9; i += 2) {
        least_of_all = min(least_of_all, around[i]);
        most_of_all = max(most_of_all, around[i]);
    }
    vec3 low = least + least_of_all, high = most + most_of_all;
    vec3 room = clamp(min(low, 2.0 - high) / max(high, vec3(1e-6)), 0.0, 1.0);
    vec3 weight = -sqrt(room) / mix(8.0, 5.0, setting(POST_SHARPEN_AMOUNT));
    vec3 plus = around[1] + around[3] + around[5] + around[7];
    return (weight * plus + around[4]) / (1.0 + 4.0 * weight);
}

vec3 rcas(vec3 around[9])
{
    const float LIMIT = 0.25 - 1.0 / 16.0, LEAST_STOPS = -2.0, NOT_0 = 1e-6;
    vec3 least = around[1], most = around[1];
    [[unroll]] for (int i = 3; i < 9; i += 2) {
        least = min(least, around[i]);
        most = max(most, around[i]);
    }
    // Weights at which the result reaches 0 and 1.
    vec3 to_0 = min(least, around[4]) / max(4.0 * most, vec3(NOT_0));
    vec3 to_1 = (1.0 - max(most, around[4])) / min(4.0 * least - 4.0, vec3(-NOT_0));
    vec3 lobes = max(-to_0, to_1);
    float lobe = max(-LIMIT, min(max(lobes.r, max(lobes.g, lobes.b)), 0.0)) *
                 exp2(LEAST_STOPS * (1.0 - setting(POST_SHARPEN_AMOUNT)));
    vec3 plus = around[1] + around[3] + around[5] + around[7];
    return (lobe * plus + around[4]) / (4.0 * lobe + 1.0);
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    vec3 around[9]; // 3x3, row by row
    [[unroll]] for (int i = 0; i < 9; i++)
        around[i] = fetch(pixel + ivec2(i % 3, i / 3) - 1);
    vec3 sharp = choice(POST_SHARPEN) == POST_SHARPEN_RCAS ? rcas(around) : cas(around);
    put(pixel, clamp(sharp, 0.0, 1.0));
}

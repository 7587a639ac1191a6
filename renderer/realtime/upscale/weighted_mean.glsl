// SPDX-License-Identifier: MIT
//
// The weighted mean of the readable upscale (upscale.comp).
#ifndef NEPH_REALTIME_WEIGHTED_MEAN_GLSL
#define NEPH_REALTIME_WEIGHTED_MEAN_GLSL

#include "upscale.glsl"

// Clamped to the range of its values: a constant stays constant, and rounding makes no radiance
// negative.
vec4 weighted_mean(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total)
{
    vec4 sum = vec4(0.0), least = vec4(FLOAT_MAX), largest = vec4(-FLOAT_MAX);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        if (weights[i] > 0.0) {
            vec4 value = taps[i].volume;
            sum += weights[i] / total * value;
            least = mix(least, value, lessThan(value, least));
            largest = mix(largest, value, greaterThan(value, largest));
        }
    sum = mix(sum, least, lessThan(sum, least));
    return mix(sum, largest, greaterThan(sum, largest));
}

#endif

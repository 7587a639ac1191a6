// SPDX-License-Identifier: MIT
//
// Two samples of the same light, s0 and later s1: the gain between them, and the residue, the
// difference that the gain does not explain. For the channels c:
//
//     gain      g_c = clamp(s1_c / s0_c, 1 - relight, 1 + relight);  s1_c / 0 counts as 1
//     residue   r   = max_c |s1_c - g_c s0_c| / max(max_c s1_c, max_c g_c s0_c)
//
// No light is negative, so r is in 0 .. 1.
#ifndef NEPH_REALTIME_GRADIENT_SAMPLES_GLSL
#define NEPH_REALTIME_GRADIENT_SAMPLES_GLSL

#include "renderer/realtime/shared/view.glsl"

// The gain from light `then` to light `now`, channel by channel.
vec3 gain_between(vec3 now, vec3 then)
{
    vec3 gain;
    for (int c = 0; c < 3; c++) {
        precise float of_channel = then[c] > 0.0 ? now[c] / then[c] : 1.0;
        float least = 1.0 - setting(RT_RELIGHT), most = 1.0 + setting(RT_RELIGHT);
        gain[c] = of_channel < least ? least : of_channel > most ? most : of_channel;
    }
    return gain;
}

// Clamps to 0 .. the largest half. A NaN becomes 0.
vec4 limit_to_half(vec4 value)
{
    vec4 below = mix(vec4(HALF_MAX), value, lessThan(value, vec4(HALF_MAX)));
    return mix(vec4(0.0), below, greaterThan(value, vec4(0.0)));
}

// Rounds to half precision, as stored samples are; an unrounded sample would always differ from
// them.
vec4 as_halves(vec4 value)
{
    vec4 limited = limit_to_half(value);
    return from_words(uvec2(pack(limited.xy), pack(limited.zw)));
}

// The place in its tile of the texel under which a tile stores its ray in this frame.
ivec2 kept_place() { return ivec2(view_frame & 1u, view_frame >> 1 & 1u); }

float largest(vec3 value)
{
    float most = value.r > value.g ? value.r : value.g;
    return most > value.b ? most : value.b;
}

// The residue of a pair under a gain.
float residue_between(vec3 now, vec3 then, vec3 gain)
{
    precise vec3 expected = gain * then;
    precise vec3 difference = abs(now - expected);
    float largest_now = largest(now), largest_expected = largest(expected);
    float most = largest_now > largest_expected ? largest_now : largest_expected;
    precise float part = largest(difference) / most;
    return most > 0.0 ? part : 0.0;
}

#endif

// SPDX-License-Identifier: MIT
//
// Luma, luminance, and the colour spaces in which colours are clamped and blended. In a space whose
// axes follow brightness and chroma, or that compresses bright light, a box around some colours is
// tighter.
#ifndef NEPH_REALTIME_COLOR_SPACE_GLSL
#define NEPH_REALTIME_COLOR_SPACE_GLSL

#include "names.h"

// Rec. 709, the primaries of every image here.
float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// 4 times the luma of YCoCg.
float luma_4(vec3 color) { return color.r + 2.0 * color.g + color.b; }

// The spaces, with luminance L:
//
//     YCOCG      Y = (R + 2 G + B) / 4,  Co = (R - B) / 2,  Cg = (2 G - R - B) / 4; all three times
//                4: sums of whole multiples are rounded less
//     REINHARD   (R, G, B) / (1 + L)
//     CHANNELS   c / (1 + |c|), each channel by itself
vec3 to_space(int space, vec3 color)
{
    switch (space) {
    case RT_SPACE_YCOCG:
        return vec3(luma_4(color), 2.0 * (color.r - color.b), 2.0 * color.g - color.r - color.b);
    case RT_SPACE_REINHARD:
        return color / (1.0 + luminance(color));
    case RT_SPACE_CHANNELS:
        return color / (1.0 + abs(color));
    default:
        return color;
    }
}

// Least distance from 1: float32 resolves no smaller one below 2^24.
const float CHANNEL_LEAST = 1.0 / 16777216.0;

// The components may stem from different colours. In YCoCg a primary can then be negative, which
// radiance cannot be. In Reinhard's space they can add up to a luminance of 1 or more, which no
// colour has; the inverse then uses the factor of a colour with the luminance `brightest`.
vec3 from_space(int space, vec3 value, float brightest)
{
    switch (space) {
    case RT_SPACE_YCOCG:
        return 0.25 * vec3(value.x + value.y - value.z, value.x + value.z,
                           value.x - value.y - value.z);
    case RT_SPACE_REINHARD:
        return value / max(1.0 - luminance(value), 1.0 / (1.0 + brightest));
    case RT_SPACE_CHANNELS:
        return value / max(1.0 - abs(value), vec3(CHANNEL_LEAST));
    default:
        return value;
    }
}

#endif

// SPDX-License-Identifier: MIT
//
// A10: the box of this frame's rays that history is held in, and the spaces to take it in. Explicit
// comparisons throughout: a NaN is on neither side of a limit and limits nothing.
#ifndef NEPH_REALTIME_BOX_GLSL
#define NEPH_REALTIME_BOX_GLSL

#include "realtime.glsl"

struct Box {
    vec4 low, high;
};

void extend(inout Box box, vec4 value)
{
    box.low = mix(box.low, value, lessThan(value, box.low));
    box.high = mix(box.high, value, greaterThan(value, box.high));
}

vec4 held(vec4 value, Box box)
{
    vec4 above = mix(value, box.low, lessThan(value, box.low));
    return mix(above, box.high, greaterThan(above, box.high));
}

// Rec. 709, the primaries of every image here.
float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// Transmittance is the same in all spaces.
vec4 to_space(int space, vec4 value)
{
    vec3 color = value.rgb;
    if (space == RT_SPACE_REINHARD)
        color /= 1.0 + luminance(color);
    else if (space == RT_SPACE_YCOCG)
        color = vec3(0.25 * color.r + 0.5 * color.g + 0.25 * color.b, 0.5 * (color.r - color.b),
                     0.5 * color.g - 0.25 * (color.r + color.b));
    return vec4(color, value.a);
}

// Components of different colours may come together. In YCoCg a primary can then be negative, which
// radiance is not. In Reinhard's space they can add up to a luminance of 1 and more, which no colour
// has there; the way back is then that of a colour with the luminance `brightest`.
vec4 from_space(int space, vec4 value, float brightest)
{
    vec3 color = value.rgb;
    if (space == RT_SPACE_REINHARD) {
        color /= max(1.0 - luminance(color), 1.0 / (1.0 + brightest));
    } else if (space == RT_SPACE_YCOCG) {
        float red_and_blue = color.x - color.z;
        color = vec3(red_and_blue + color.y, color.x + color.z, red_and_blue - color.y);
        color = mix(color, vec3(0.0), lessThan(color, vec3(0.0)));
    }
    return vec4(color, value.a);
}

// The box is about `first`. What is in it already comes out as it is, without the rounding of there
// and back.
vec4 held_in_space(int space, vec4 value, vec4 first, Box box)
{
    vec4 seen = to_space(space, value);
    vec4 limited = held(seen, box);
    float brightest = max(luminance(value.rgb), luminance(first.rgb));
    return limited == seen ? value : from_space(space, limited, brightest);
}

#endif

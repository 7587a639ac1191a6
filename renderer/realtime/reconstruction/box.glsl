// SPDX-License-Identifier: MIT
//
// The neighbourhood clamp: the box of this frame's rays that history is held in, and the colour
// spaces to take it in. Explicit comparisons throughout: a NaN is on neither side of a limit and
// limits nothing.
#ifndef NEPH_REALTIME_BOX_GLSL
#define NEPH_REALTIME_BOX_GLSL

#include "renderer/realtime/shared/view.glsl"

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

// HDRP's ClipCloudsToRegion: the colour goes towards the middle of the box until it is inside, the
// transmittance to its nearest side. A side of no width is reached in the middle.
vec4 clipped(vec4 value, Box box)
{
    vec4 limited = held(value, box);
    if (limited.rgb == value.rgb)
        return limited;
    vec3 centre = 0.5 * (box.low.rgb + box.high.rgb);
    vec3 reach = 0.5 * (box.high.rgb - box.low.rgb);
    vec3 offset = value.rgb - centre;
    float part = 1.0;
    for (int c = 0; c < 3; c++)
        if (abs(offset[c]) > reach[c])
            part = min(part, reach[c] / abs(offset[c]));
    return vec4(centre + part * offset, limited.a);
}

// Rec. 709, the primaries of every image here.
float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// Transmittance is the same in all spaces.
vec4 to_space(int space, vec4 value)
{
    vec3 color = value.rgb;
    if (space == RT_SPACE_REINHARD)
        color /= 1.0 + luminance(color);
    else if (space == RT_SPACE_CHANNELS)
        color /= 1.0 + color;
    else if (space == RT_SPACE_YCOCG)
        color = vec3(0.25 * color.r + 0.5 * color.g + 0.25 * color.b, 0.5 * (color.r - color.b),
                     0.5 * color.g - 0.25 * (color.r + color.b));
    return vec4(color, value.a);
}

// Where 1 is as near as float32 comes to it, from 2^24 on.
const float CHANNEL_LEAST = 1.0 / 16777216.0;

// Components of different colours may come together. In YCoCg a primary can then be negative, which
// radiance is not. In Reinhard's space they can add up to a luminance of 1 and more, which no
// colour has there; the way back is then that of a colour with the luminance `brightest`.
vec4 from_space(int space, vec4 value, float brightest)
{
    vec3 color = value.rgb;
    if (space == RT_SPACE_REINHARD) {
        color /= max(1.0 - luminance(color), 1.0 / (1.0 + brightest));
    } else if (space == RT_SPACE_CHANNELS) {
        color /= max(1.0 - color, vec3(CHANNEL_LEAST));
    } else if (space == RT_SPACE_YCOCG) {
        float red_and_blue = color.x - color.z;
        color = vec3(red_and_blue + color.y, color.x + color.z, red_and_blue - color.y);
        color = mix(color, vec3(0.0), lessThan(color, vec3(0.0)));
    }
    return vec4(color, value.a);
}

// The box is about `first`. A colour that is in it already comes out as it is, without the rounding
// of there and back.
vec4 held_in_space(int space, vec4 value, vec4 first, Box box)
{
    vec4 seen = to_space(space, value);
    vec4 limited = choice(RT_BOX_HOLD) == RT_HOLD_CLIP ? clipped(seen, box) : held(seen, box);
    float brightest = max(luminance(value.rgb), luminance(first.rgb));
    vec3 color = limited.rgb == seen.rgb ? value.rgb : from_space(space, limited, brightest).rgb;
    return vec4(color, limited.a);
}

#endif

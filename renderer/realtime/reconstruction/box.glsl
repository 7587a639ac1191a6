// SPDX-License-Identifier: MIT
//
// The neighbourhood clamp of a history of colour and transmittance, in a colour space.
// Transmittance is the same in all of them.
#ifndef NEPH_REALTIME_BOX_GLSL
#define NEPH_REALTIME_BOX_GLSL

#include "renderer/realtime/shared/clamp.glsl"
#include "renderer/realtime/shared/color_space.glsl"
#include "renderer/realtime/shared/view.glsl"

vec4 to_space(int space, vec4 value) { return vec4(to_space(space, value.rgb), value.a); }

vec4 from_space(int space, vec4 value, float brightest)
{
    vec3 color = from_space(space, value.rgb, brightest);
    if (space == RT_SPACE_YCOCG)
        color = mix(color, vec3(0.0), lessThan(color, vec3(0.0)));
    return vec4(color, value.a);
}

// HDRP's ClipCloudsToRegion: the colour moves towards the centre of the box until it is inside, the
// transmittance to the nearest limit. With a width of 0 the colour becomes the centre.
vec4 clip_to(Box box, vec4 value)
{
    vec4 clamped = clamp_to(box, value);
    if (clamped.rgb == value.rgb)
        return clamped;
    vec3 centre = 0.5 * (box.low.rgb + box.high.rgb);
    vec3 half_width = 0.5 * (box.high.rgb - box.low.rgb);
    vec3 offset = value.rgb - centre;
    float part = 1.0;
    for (int c = 0; c < 3; c++)
        if (abs(offset[c]) > half_width[c])
            part = min(part, half_width[c] / abs(offset[c]));
    return vec4(centre + part * offset, clamped.a);
}

// The box is around `first`. A colour inside it is returned bit by bit, without conversion to the
// space and back.
vec4 clamp_in_space(int space, vec4 value, vec4 first, Box box)
{
    vec4 seen = to_space(space, value);
    vec4 clamped = choice(RT_BOX_HOLD) == RT_HOLD_CLIP ? clip_to(box, seen) : clamp_to(box, seen);
    float brightest = max(luminance(value.rgb), luminance(first.rgb));
    vec3 color = clamped.rgb == seen.rgb ? value.rgb : from_space(space, clamped, brightest).rgb;
    return vec4(color, clamped.a);
}

#endif

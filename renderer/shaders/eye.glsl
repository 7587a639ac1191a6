// SPDX-License-Identifier: MIT
//
// State of automatic exposure ("the eye"): its buffer and the exposure that follows from it. The
// histogram is filled by post_meter.comp, the adaptation is post_adapt.comp.
#ifndef NEPH_EYE_GLSL
#define NEPH_EYE_GLSL

#include "post.glsl"

layout(std430, binding = 4) buffer Eye {
    float adapted_ev, target_ev; // log2 of luminance: adapted to, and heading for
    // Histogram of the frame's log2 luminance. Per bin: number of pixels, and the sum of their
    // distances above the bin's lower end.
    uint eye_counts[POST_METER_BINS], eye_offsets[POST_METER_BINS];
};

// Luminance of linear light, ITU-R BT.709.
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Exposure in stops: the tone mapper gets the radiance times 2^exposure. With automatic exposure
// the luminance that the eye is adapted to becomes middle grey (0.18).
float exposure_ev()
{
    const float GREY_EV = -2.47393118833; // log2(0.18)
    float ev = setting(POST_EXPOSURE_EV);
    return choice(POST_AUTO_EXPOSURE) != 0 ? ev + GREY_EV - adapted_ev : ev;
}

#endif

// SPDX-License-Identifier: MIT
//
// What the eye of automatic exposure is adapted to.
#ifndef NEPH_EYE_GLSL
#define NEPH_EYE_GLSL

#include "post.glsl"

layout(std430, binding = 4) buffer Eye {
    float adapted_ev, target_ev; // log2 of luminance
    // By bin: how many of the frame's pixels, and how far above its lower end they are, in all.
    uint eye_counts[POST_METER_BINS], eye_offsets[POST_METER_BINS];
};

// ITU-R BT.709, of linear light.
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Radiance times 2^this is what is mapped: what the eye is adapted to becomes grey.
float exposure_ev()
{
    const float GREY_EV = -2.47393118833; // log2 of 0.18
    float ev = setting(POST_EXPOSURE_EV);
    return choice(POST_AUTO_EXPOSURE) != 0 ? ev + GREY_EV - adapted_ev : ev;
}

#endif

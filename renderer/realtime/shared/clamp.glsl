// SPDX-License-Identifier: MIT
//
// The neighbourhood clamp: a box around the values of some samples, and a value that is moved into
// it. History outside the range of this frame's samples around it is outdated; the result is the
// nearest value inside their range.
//
//   high +-----------+        o  samples
//        |  o     o  |
//        |     o  o  | <-- x  the history's value, clamped: channel by channel
//        |   o       |
//    low +-----------+
//
// The box is made of the extremes of the samples, or of their mean and variance: M. Salvi, "An
// Excursion in Temporal Supersampling", GDC 2016. Comparisons are written out, because min(), max()
// and clamp() may do anything with a NaN: here a NaN extends no box and is never moved.
#ifndef NEPH_REALTIME_CLAMP_GLSL
#define NEPH_REALTIME_CLAMP_GLSL

struct Box {
    vec4 low, high; // low > high in a channel without samples
};

const Box EMPTY_BOX = Box(vec4(3e38), vec4(-3e38));

void extend(inout Box box, vec4 value)
{
    box.low = mix(box.low, value, lessThan(value, box.low));
    box.high = mix(box.high, value, greaterThan(value, box.high));
}

// `sigma` standard deviations about a mean.
Box variance_box(vec4 mean, vec4 variance, float sigma)
{
    vec4 half_width = sigma * sqrt(variance);
    return Box(mean - half_width, mean + half_width);
}

// With low > high the value stays as it is.
vec4 clamp_to(Box box, vec4 value)
{
    vec4 above = mix(value, box.low, lessThan(value, box.low));
    vec4 clamped = mix(above, box.high, greaterThan(above, box.high));
    return mix(clamped, value, greaterThan(box.low, box.high));
}

vec3 clamp_between(vec3 value, vec3 low, vec3 high)
{
    return clamp_to(Box(vec4(low, 0.0), vec4(high, 0.0)), vec4(value, 0.0)).rgb;
}

#endif

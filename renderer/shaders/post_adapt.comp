#version 450
// SPDX-License-Identifier: MIT
//
// Adaptation of automatic exposure. The target is the mean of log2 luminance between two
// percentiles of the histogram (post_meter.comp). The adapted value moves towards it with a
// constant speed while the distance is large, and exponentially when it is small:
//
//   d/dt distance = -speed min(distance / near, 1)
//
// solved in closed form over the frame's time, so two half steps equal a whole one. At the first
// frame the eye is adapted already.
#extension GL_GOOGLE_include_directive : require

#include "eye.glsl"

// One thread sums up the bins in order; all threads load them.
shared uint counts[POST_METER_BINS], offsets[POST_METER_BINS];

void fetch_bins()
{
    for (uint i = gl_LocalInvocationID.x; i < POST_METER_BINS; i += gl_WorkGroupSize.x) {
        counts[i] = eye_counts[i];
        offsets[i] = eye_offsets[i];
    }
    barrier();
}

// Mean log2 luminance of a bin's pixels.
float mean_ev(int bin)
{
    float offset = float(offsets[bin]) / float(view.meter_units) / float(counts[bin]);
    return POST_METER_FIRST_EV + (float(bin) + offset) / POST_METER_BINS_PER_EV;
}

// The target: mean of log2 luminance between the percentiles. Bins that a percentile cuts count in
// part.
float metered_ev()
{
    float total = float(from_size().x) * float(from_size().y);
    float low = 0.01 * setting(POST_METER_LOW_PERCENT) * total;
    float high = 0.01 * setting(POST_METER_HIGH_PERCENT) * total;
    float below = 0.0, sum = 0.0, weights = 0.0;
    for (int bin = 0; bin < POST_METER_BINS; bin++) {
        float above = below + float(counts[bin]);
        float weight = max(min(above, high) - max(below, low), 0.0);
        sum += weight > 0.0 ? weight * mean_ev(bin) : 0.0;
        weights += weight;
        below = above;
    }
    return clamp(sum / weights, setting(POST_EXPOSURE_MIN_EV), setting(POST_EXPOSURE_MAX_EV));
}

float adapted(float from_ev, float to_ev)
{
    float distance = abs(to_ev - from_ev), near = setting(POST_ADAPT_NEAR_EV);
    float speed = setting(to_ev > from_ev ? POST_ADAPT_UP : POST_ADAPT_DOWN);
    // The part at constant speed.
    float far_ev = min(max(distance - near, 0.0), speed * view.step_s);
    float near_s = speed > 0.0 ? view.step_s - far_ev / speed : 0.0;
    float rest = (distance - far_ev) * exp(-speed / near * max(near_s, 0.0));
    return to_ev + (to_ev > from_ev ? -rest : rest);
}

void main()
{
    fetch_bins();
    if (get_thread_index() != 0)
        return;
    target_ev = metered_ev();
    adapted_ev = view.is_eye_open != 0 ? adapted(view.eye_ev, target_ev) : target_ev;
}

#version 450
// SPDX-License-Identifier: MIT
//
// The meter of automatic exposure: a histogram of log2 luminance. Each bin has the number of its
// pixels and the sum of their positions in the bin, so that the mean of a flat image is exact. Both
// are integer sums, so the result does not depend on the order of the threads.
#extension GL_GOOGLE_include_directive : require

#include "eye.glsl"

shared uint own_counts[POST_METER_BINS], own_offsets[POST_METER_BINS];

// Position in bins, from the lower end of the first bin.
float place_of_luminance(float y)
{
    const float LEAST = 1e-30; // finite logarithm for black, which goes into the first bin
    float place = (log2(max(y, LEAST)) - POST_METER_FIRST_EV) * POST_METER_BINS_PER_EV;
    return clamp(place, 0.0, float(POST_METER_BINS));
}

void count(vec3 colour)
{
    float place = place_of_luminance(luminance(colour));
    uint bin = min(uint(place), uint(POST_METER_BINS - 1));
    atomicAdd(own_counts[bin], 1);
    atomicAdd(own_offsets[bin], uint((place - float(bin)) * float(view.meter_units) + 0.5));
}

void main()
{
    const uint GROUP = gl_WorkGroupSize.x;
    uint local = gl_LocalInvocationID.x, end = uint(from_size().x * from_size().y);
    for (uint i = local; i < POST_METER_BINS; i += GROUP)
        own_counts[i] = own_offsets[i] = 0;
    barrier();
    uint first = (get_thread_index() - local) * POST_METER_PIXELS + local;
    for (uint i = 0; i < POST_METER_PIXELS; i++) {
        uint pixel = first + i * GROUP;
        if (pixel < end)
            count(from_texels[pixel].rgb);
    }
    barrier();
    for (uint i = local; i < POST_METER_BINS; i += GROUP)
        if (own_counts[i] != 0) {
            atomicAdd(eye_counts[i], own_counts[i]);
            atomicAdd(eye_offsets[i], own_offsets[i]);
        }
}

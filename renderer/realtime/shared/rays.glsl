// SPDX-License-Identifier: MIT
//
// For passes of the real-time renderer with rays: the march (bindings 0 to 5 and 7 to 10), its
// counters (6), and after it the view and the targets.
#ifndef NEPH_REALTIME_MARCH_GLSL
#define NEPH_REALTIME_MARCH_GLSL

#include "renderer/shaders/counting.glsl"
#include "renderer/shaders/march.glsl"

#define REALTIME_BINDING 11
#include "view.glsl"

layout(std430, binding = 6) buffer Counters {
    uint rays;
    uint view_steps[2]; // lower and upper half, as below
    uint density_evaluations[2];
    uint closed_forms[2];
} counters;

// Frames in flight do not count: their counters are never read.
layout(constant_id = RT_UNCOUNTED_CONSTANT) const bool UNCOUNTED = false;

void count_cost()
{
    if (UNCOUNTED)
        return;
    ADD_64(counters.view_steps, view_steps);
    ADD_64(counters.density_evaluations, density_evaluations);
    ADD_64(counters.closed_forms, closed_forms);
}

#endif

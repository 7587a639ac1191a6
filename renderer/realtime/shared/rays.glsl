// SPDX-License-Identifier: MIT
//
// For the passes of the real-time renderer that look at the scene: the march (bindings 0 to 5
// and 7 to 10), what it has cost, and behind it the view and its targets.
#ifndef NEPH_REALTIME_MARCH_GLSL
#define NEPH_REALTIME_MARCH_GLSL

#include "renderer/shaders/counting.glsl"
#include "renderer/shaders/march.glsl"

#define REALTIME_BINDING 11
#include "view.glsl"

layout(std430, binding = 6) buffer Counters {
    uint rays;
    uint view_steps[2]; // lower and upper half, as of the others
    uint density_evaluations[2];
    uint closed_forms[2];
} counters;

// lavapipe gives each core as many work groups that follow each other, so that one has the sky and
// waits for that which has the clouds. Groups of a picture are taken as by a comb: each core has a
// part of everything. The number of a ray, of `count` in a picture; a permutation.
int spread(int ray, int count)
{
    const int group_rays = 64, teeth = 16;
    int rows = count / group_rays / teeth, group = ray / group_rays;
    if (ON_GPU || group >= teeth * rows)
        return ray;
    ivec2 place = element_at(group, max(rows, 1));
    return group_rays * (teeth * place.x + place.y) + ray % group_rays;
}

// Nobody will look at the counters: frames in flight.
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

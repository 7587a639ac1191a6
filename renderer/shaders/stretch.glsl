// SPDX-License-Identifier: MIT
//
// A part of a ray, and the hull of several.
#ifndef NEPH_STRETCH_GLSL
#define NEPH_STRETCH_GLSL

struct Stretch {
    float t0_m, t1_m; // empty when t1 <= t0
};

// Extends the hull by [start, end].
void include(inout Stretch hull, float start_m, float end_m)
{
    if (start_m < end_m) {
        hull.t0_m = min(hull.t0_m, start_m);
        hull.t1_m = max(hull.t1_m, end_m);
    }
}

#endif

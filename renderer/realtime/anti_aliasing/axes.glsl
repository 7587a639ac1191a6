// SPDX-License-Identifier: MIT
//
// Where the camera before saw what this frame's sees at a place: by what the axes of the one are to
// the other, the same for all pixels, in a fraction of the instructions that two projections take.
// For a GPU, and rays from one point.
#ifndef NEPH_REALTIME_AXES_GLSL
#define NEPH_REALTIME_AXES_GLSL

#include "renderer/realtime/shared/view.glsl"

float dot_in_order(vec3 a, vec3 b)
{
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

// A way by the axes of the camera before: right and down in halves of its picture at eye depth 1,
// and ahead.
vec3 seen_before(vec3 way)
{
    return vec3(dot_in_order(way, view_before.right) / view_before.half_width,
                -dot_in_order(way, view_before.up) / view_before.half_height,
                dot_in_order(way, view_before.forward));
}

// On a GPU: what half a picture to the right, half a picture down and the way ahead are to the
// camera before. Of one that has not turned all is exactly as it was.
bool has_turned = !(view_now.right == view_before.right && view_now.up == view_before.up &&
                    view_now.forward == view_before.forward &&
                    view_now.half_width == view_before.half_width &&
                    view_now.half_height == view_before.half_height);
vec3 across_before = has_turned ? view_now.half_width * seen_before(view_now.right)
                                : vec3(1.0, 0.0, 0.0);
vec3 down_before = has_turned ? -view_now.half_height * seen_before(view_now.up)
                              : vec3(0.0, 1.0, 0.0);
vec3 ahead_before = has_turned ? seen_before(view_now.forward) : vec3(0.0, 0.0, 1.0);

bool goes_by_axes() { return ON_GPU && view_now.is_parallel == 0u; }

// The place in the frame before, times Z, of what is `depth_m` deep at a place now, and stood
// `from_m` off then. Places are from the middle, in halves of a picture; Z is above 0 before the
// camera.
vec3 seen_at(vec2 from_middle, float depth_m, vec3 from_m)
{
    precise vec3 seen = from_middle.x * across_before + from_middle.y * down_before +
                        ahead_before - 1.0 / depth_m * seen_before(from_m);
    return seen;
}

#endif

// SPDX-License-Identifier: MIT
//
// Ray intersection with a few solids that are known at compile time (specialization constants:
// their number, and which of them are balls). Only for lavapipe, for three reasons:
// - It reads a uniform once for all threads before the first branch, and per thread after it.
// - It executes both sides of every branch.
// - A loop that it cannot unroll runs until the last thread has left it.
//
// All solids are therefore read at the start of main() and intersected in an unrolled loop without
// branches.
#ifndef NEPH_KNOWN_SOLIDS_GLSL
#define NEPH_KNOWN_SOLIDS_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/shared/names.h"

layout(constant_id = RT_SOLIDS_CONSTANT) const uint KNOWN_SOLIDS = RT_SOLIDS_UNKNOWN;
// One bit per solid: the solid is a ball. The second constant has solids 32 and above.
layout(constant_id = RT_BALLS_CONSTANT) const uint KNOWN_BALLS = ~0u;
layout(constant_id = RT_BALLS_CONSTANT + 1) const uint MORE_KNOWN_BALLS = ~0u;

const bool ARE_KNOWN = READS_SOLIDS_ONCE && KNOWN_SOLIDS != RT_SOLIDS_UNKNOWN;

Solid known_solids[RT_SOLIDS_UNKNOWN];

// Reads all solids. Call it at the start of main(), before any branch.
void load_known_solids()
{
    if (ARE_KNOWN)
        [[unroll]] for (uint s = 0; s < KNOWN_SOLIDS; s++) {
            known_solids[s] = solids[s];
            known_solids[s].kind = make_nonuniform(solids[s].kind);
            known_solids[s].albedo.w =
                uintBitsToFloat(make_nonuniform(floatBitsToUint(solids[s].albedo.w)));
        }
}

// Selects among the copies: cheaper than an indexed read per thread.
Solid known_solid(uint solid)
{
    Solid found = known_solids[0];
    [[unroll]] for (uint s = 1; s < KNOWN_SOLIDS; s++)
        if (s == solid)
            found = known_solids[s];
    return found;
}

// clip_axis() without branches. It does not test t0 < t1: once false, the test stays false and is
// done at the end. Comparisons replace min() and max(), because lavapipe's test for NaN, which
// cannot occur here.
bool narrow_axis(float low, float high, float origin, float direction, inout float t0,
                 inout float t1)
{
    bool is_parallel = abs(direction) < PARALLEL;
    float a = (low - origin) / direction;
    float b = (high - origin) / direction;
    bool is_low_first = a < b;
    float first = is_low_first ? a : b, second = is_low_first ? b : a;
    t0 = !is_parallel && first > t0 ? first : t0;
    t1 = !is_parallel && second < t1 ? second : t1;
    return !is_parallel || (origin >= low && origin <= high);
}

// solid_interval() for a known solid.
bool known_interval(uint s, vec3 origin_m, vec3 direction, out float t0_m, out float t1_m)
{
    Solid solid = known_solids[s];
    if (((s < 32u ? KNOWN_BALLS : MORE_KNOWN_BALLS) >> (s & 31u) & 1u) != 0u)
        return ball_interval(solid, origin_m, direction, t0_m, t1_m);
    bool turns = is_turned(solid);
    origin_m = turns ? to_box_axes(solid, origin_m) : origin_m;
    direction = turns ? turned(solid, direction, -solid.albedo.w) : direction;
    t0_m = -FAR_M;
    t1_m = FAR_M;
    bool meets_x = narrow_axis(solid.low_m.x, solid.high_m.x, origin_m.x, direction.x, t0_m, t1_m);
    bool meets_y = narrow_axis(solid.low_m.y, solid.high_m.y, origin_m.y, direction.y, t0_m, t1_m);
    bool meets_z = narrow_axis(solid.low_m.z, solid.high_m.z, origin_m.z, direction.z, t0_m, t1_m);
    return meets_x && meets_y && meets_z && t0_m < t1_m;
}

// sees_point() for known solids: whether all of them leave the segment up to `distance_m` free.
bool known_sees_point(vec3 point_m, vec3 direction, float start_m, float distance_m, uint except)
{
    bool let_pass = true;
    [[unroll]] for (uint s = 0; s < KNOWN_SOLIDS; s++) {
        float t0_m, t1_m;
        bool meets = known_interval(s, point_m, direction, t0_m, t1_m);
        let_pass = let_pass && !(s != except && meets && t1_m > start_m && t0_m < distance_m);
    }
    return let_pass;
}

#endif

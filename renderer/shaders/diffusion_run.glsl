// SPDX-License-Identifier: MIT
//
// What a pass over one level of diffused light's cells is told, and bound to (diffusion.glsl).
#ifndef NEPH_DIFFUSION_RUN_GLSL
#define NEPH_DIFFUSION_RUN_GLSL

#include "diffusion.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform DiffusionRun {
    DiffusionLevel level; // one thread for each of its cells
    DiffusionLevel other; // the next coarser one, or the next finer one
    vec3 sides_m; // of a cell of the finest level; 1 along an axis of one cell, which has no end
    uint job;
    vec3 beam; // the way of sunlight, unit
    float outward; // part of the fluence that leaves a medium where nothing comes in
} run;

layout(std430, binding = 0) buffer Cells {
    DiffusionCell cells[];
};

bool has_faces(int axis) { return run.level.size[axis] > 1u; }

bool is_solid(DiffusionCell cell) { return cell.opacity_per_m < 0.0; }

// Difference of fluence over flux, for half a cell along an axis.
float resistance(DiffusionCell cell, int axis)
{
    return 0.5 * run.sides_m[axis] * cell.opacity_per_m;
}

// The flux through a face between two cells is conductance (low - high) + beam.
struct Face {
    float conductance, beam;
};

Face face_between(DiffusionCell low, DiffusionCell high, int axis)
{
    float r_low = resistance(low, axis), r_high = resistance(high, axis);
    return Face(1.0 / (r_low + r_high),
                run.beam[axis] * (r_low * low.beam + r_high * high.beam) / (r_low + r_high));
}

// Through one behind which nothing is, `outward` +1 or -1 along the axis: conductance fluence +
// beam, outwards.
Face open_face(DiffusionCell cell, int axis, float outward)
{
    float r = resistance(cell, axis);
    float all = 1.0 / run.outward + r;
    return Face(1.0 / all, outward * run.beam[axis] * r * cell.beam / all);
}

float area_m2(int axis)
{
    return run.sides_m.x * run.sides_m.y * run.sides_m.z / run.sides_m[axis];
}

// A face may always pass on half of the difference between its sides: where one of them is dark
// that is Marshak's flux.
const float PASSES_ALWAYS = 0.5;

// Where all light leaves to one side, as from a surface into the void, this part of the fluence is
// its flux, and more is so only by what passes always: the condition at open faces wherever
// a medium ends.
float limited(Face face, float low, float high)
{
    float apart = low - high, room = run.outward * max(low, high) + abs(face.beam);
    if (face.conductance * abs(apart) <= room)
        return face.conductance;
    return min(face.conductance, max(room / abs(apart), PASSES_ALWAYS));
}

#endif

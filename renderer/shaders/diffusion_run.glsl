// SPDX-License-Identifier: MIT
//
// Push constants, buffers and face fluxes that the passes over a level of diffused light share
// (diffusion.glsl).
#ifndef NEPH_DIFFUSION_RUN_GLSL
#define NEPH_DIFFUSION_RUN_GLSL

#include "diffusion.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform DiffusionRun {
    DiffusionLevel level; // one thread per cell of this level
    DiffusionLevel other; // the next coarser or the next finer one
    vec3 sides_m; // of the finest level's cells; 1 along an axis of one cell, which has no faces
    uint job;
    vec3 beam; // direction of sunlight, unit
    float outward; // flux through an open face over the fluence: NEPH_GPU_OUTWARD or Marshak's 0.5
} run;

layout(std430, binding = 0) buffer Cells {
    DiffusionCell cells[];
};

bool has_faces(int axis) { return run.level.size[axis] > 1u; }

bool is_solid(DiffusionCell cell) { return cell.opacity_per_m < 0.0; }

// Resistance of half a cell along an axis: difference of fluence over flux density. From the second
// equation, grad phi = -3 sigma_tr F, it is 3 sigma_tr times half of the side.
float resistance(DiffusionCell cell, int axis)
{
    return 0.5 * run.sides_m[axis] * cell.opacity_per_m;
}

// The flux density through a face is conductance (low - high) + beam.
struct Face {
    float conductance, beam;
};

// Face between two cells: the resistances of the two half cells are in series. The sunlight term is
// their mean, weighted with the resistances.
Face face_between(DiffusionCell low, DiffusionCell high, int axis)
{
    float r_low = resistance(low, axis), r_high = resistance(high, axis);
    return Face(1.0 / (r_low + r_high),
                run.beam[axis] * (r_low * low.beam + r_high * high.beam) / (r_low + r_high));
}

// Face without a cell behind it, `outward` = +1 or -1 along the axis. The outward flux density is
// conductance fluence + beam, with the resistance of the boundary condition, 1 / run.outward, in
// series.
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

// Lower bound of a limited conductance: the limiter leaves at least half of the difference between
// the sides. With one side dark this is Marshak's flux.
const float PASSES_ALWAYS = 0.5;

// Flux limiter: the conductance of a face, reduced so that the flux does not exceed run.outward *
// (fluence of the brighter side) + |beam|, the flux of a surface that emits into empty space. It
// applies the boundary condition of open faces wherever a medium ends inside the grid.
// PASSES_ALWAYS bounds the conductance from below.
float limited(Face face, float low, float high)
{
    float apart = low - high, room = run.outward * max(low, high) + abs(face.beam);
    if (face.conductance * abs(apart) <= room)
        return face.conductance;
    return min(face.conductance, max(room / abs(apart), PASSES_ALWAYS));
}

#endif

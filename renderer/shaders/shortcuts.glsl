// SPDX-License-Identifier: MIT
//
// Approximations of the ray marcher, each enabled by a bit of a specialization constant (struct
// neph_shortcuts): growing steps, empty-space skipping, early ray termination. The ones for sun
// rays are in sun_cache.glsl and cloud_shadow.glsl. Measurements: docs/realtime.md.
#ifndef NEPH_SHORTCUTS_GLSL
#define NEPH_SHORTCUTS_GLSL

#include "scene.glsl"
#include "settings/march_shortcut_bits.h"

// Bits of settings (renderer/march_settings.toml) and of neph_march_constants().
layout(constant_id = 5) const uint SHORTCUTS = 0;
const bool CACHES_SUN = (SHORTCUTS & NEPH_SHORTCUT_SUN_CACHE) != 0u && SHAPE_KINDS != 0u;
const bool SKIPS = (SHORTCUTS & NEPH_SHORTCUT_SKIP) != 0u && SHAPE_KINDS != 0u;
const bool ENDS_EARLY = (SHORTCUTS & NEPH_SHORTCUT_EARLY_OUT) != 0u;
const bool GROWS = (SHORTCUTS & NEPH_SHORTCUT_STEP_GROWTH) != 0u;
const bool GROWS_BY_DEPTH = (SHORTCUTS & NEPH_SHORTCUT_DEPTH_GROWTH) != 0u;
const uint SUN_RAY_BITS = NEPH_SHORTCUT_SUN_GROWTH | NEPH_SHORTCUT_SUN_CONE;
// Growing steps, in a cone or on the ray.
const bool GROWS_SUN_RAYS = (SHORTCUTS & SUN_RAY_BITS) != 0u;
const bool CONES_SUN_RAYS = (SHORTCUTS & NEPH_SHORTCUT_SUN_CONE) != 0u;
const bool MANY_OCTAVES = (SHORTCUTS & 4096u) != 0u; // more than KEPT_PHASES octaves
// Grids are in textures, media scatter sunlight and emit none, and octaves are at most KEPT_PHASES.
const bool SUNLIT_TEXTURE = (SHORTCUTS & 2048u) != 0u;
const bool MAPS_SHADOW = (SHORTCUTS & NEPH_SHORTCUT_CLOUD_SHADOW) != 0u && SHAPE_KINDS != 0u;

// --- steps of a stretch -----------------------------------------------------------------------

struct Steps {
    Stretch stretch;
    float step_m; // length of a step, if all are equal
    uint count;
    float growth; // ratio of successive lengths; 1: equal
    uint span, end; // GROWS_BY_DEPTH: number of steps that are joined, and the end of this run
};

Steps equal_steps(Stretch stretch, uint count)
{
    return Steps(stretch, (stretch.t1_m - stretch.t0_m) / float(count), count, 1.0, 1, ~0u);
}

Steps make_view_steps(Stretch stretch)
{
    Steps steps = equal_steps(stretch, frame.steps);
    steps.growth = frame.step_growth;
    return steps;
}

// Number of steps that are joined behind an optical depth. It is an integer, so that the joined
// steps have the same boundaries as the single ones.
uint span_behind(float optical_depth)
{
    return uint(min(1.0 + frame.depth_growth * optical_depth, float(NEPH_GPU_SPAN_MAX)));
}

// The step after step i, or after the joined steps from i on.
uint step_after(Steps steps, uint i)
{
    return GROWS_BY_DEPTH ? min(i + steps.span, steps.end) : i + 1;
}

bool are_equal(Steps steps) { return !GROWS || make_nonuniform(steps.growth == 1.0); }

// Start of a step when lengths are a geometric progression with ratio g:
//
//   t_i = t0 + (t1 - t0) (g^i - 1) / (g^n - 1)
float grown_start_m(Steps steps, uint i)
{
    float part = (pow(steps.growth, float(i)) - 1.0) /
                 (pow(steps.growth, float(steps.count)) - 1.0);
    return mix(steps.stretch.t0_m, steps.stretch.t1_m, part);
}

float step_start_m(Steps steps, uint i)
{
    return are_equal(steps) ? steps.stretch.t0_m + float(i) * steps.step_m
                            : grown_start_m(steps, i);
}

float step_length_m(Steps steps, uint i)
{
    uint after = step_after(steps, i);
    if (are_equal(steps))
        return GROWS_BY_DEPTH ? float(after - i) * steps.step_m : steps.step_m;
    return grown_start_m(steps, after) - grown_start_m(steps, i);
}

// The sample of a step, at `place` (0..1) of its length.
float step_point_m(Steps steps, uint i, float place)
{
    uint after = step_after(steps, i);
    if (are_equal(steps)) {
        float part = GROWS_BY_DEPTH ? float(after - i) * place : place;
        return steps.stretch.t0_m + (float(i) + part) * steps.step_m;
    }
    return mix(grown_start_m(steps, i), grown_start_m(steps, after), place);
}

// --- empty cells ------------------------------------------------------------------------------

// One bit per cell of frame.skip_lattice, x fastest, 32 cells to a word: whether a shape may have
// density in the cell or within rounding distance around it (renderer/skip_cells.c). The binding is
// that of the majorants, which the ray marcher does not use.
layout(std430, binding = 3) readonly buffer SkipCells {
    uint skip_cells[];
};

// `place` is in cells. Outside the grid there are no shapes, so every answer is valid.
bool cell_is_empty(vec3 place)
{
    uvec3 size = frame.skip_lattice.size;
    uvec3 cell = uvec3(clamp(place, vec3(0.0), vec3(size) - 1.0));
    uint at = cell.x + size.x * (cell.y + size.y * cell.z);
    return (skip_cells[at >> 5] >> (at & 31u) & 1u) == 0u;
}

bool shapes_are_empty(vec3 point_m)
{
    return cell_is_empty((point_m - frame.skip_lattice.origin_m) * frame.skip_lattice.per_m);
}

// Moves `i` on to the first step with its sample in a non-empty cell, or to `end`; returns whether
// a step was skipped. A loop of its own, so that rays do their non-empty steps together afterwards.
bool pass_empty_steps(Steps steps, float place, vec3 origin_m, vec3 direction, uint end,
                      inout uint i)
{
    vec3 start = (origin_m - frame.skip_lattice.origin_m) * frame.skip_lattice.per_m;
    vec3 slope = direction * frame.skip_lattice.per_m;
    uint first = i;
    while (i < end && cell_is_empty(start + step_point_m(steps, i, place) * slope))
        i = step_after(steps, i);
    return i > first;
}

#endif

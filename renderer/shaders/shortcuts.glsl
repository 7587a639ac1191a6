// SPDX-License-Identifier: MIT
//
// Shortcuts of a march through media, each off unless the specialization constant has its bit
// (struct neph_shortcuts): steps that grow, empty cells that are passed, rays that end early. Those
// of the sun are in sun_cache.glsl and cloud_shadow.glsl.
#ifndef NEPH_SHORTCUTS_GLSL
#define NEPH_SHORTCUTS_GLSL

#include "scene.glsl"
#include "settings/march_shortcut_bits.h"

// Bits of settings (renderer/march_settings.toml), and of neph_march_constants().
layout(constant_id = 5) const uint SHORTCUTS = 0;
const bool CACHES_SUN = (SHORTCUTS & NEPH_SHORTCUT_SUN_CACHE) != 0u && SHAPE_KINDS != 0u;
const bool SKIPS = (SHORTCUTS & NEPH_SHORTCUT_SKIP) != 0u && SHAPE_KINDS != 0u;
const bool ENDS_EARLY = (SHORTCUTS & NEPH_SHORTCUT_EARLY_OUT) != 0u;
const bool GROWS = (SHORTCUTS & NEPH_SHORTCUT_STEP_GROWTH) != 0u;
const bool GROWS_BY_DEPTH = (SHORTCUTS & NEPH_SHORTCUT_DEPTH_GROWTH) != 0u;
const uint SUN_RAY_BITS = NEPH_SHORTCUT_SUN_GROWTH | NEPH_SHORTCUT_SUN_CONE;
const bool GROWS_SUN_RAYS = (SHORTCUTS & SUN_RAY_BITS) != 0u; // or has them in a cone
const bool CONES_SUN_RAYS = (SHORTCUTS & NEPH_SHORTCUT_SUN_CONE) != 0u;
const bool MANY_OCTAVES = (SHORTCUTS & 4096u) != 0u; // more than a ray keeps the phases of
const bool SUNLIT_TEXTURE = (SHORTCUTS & 2048u) != 0u; // media emit nothing and see the sun
const bool MAPS_SHADOW = (SHORTCUTS & NEPH_SHORTCUT_CLOUD_SHADOW) != 0u && SHAPE_KINDS != 0u;

// --- steps of a stretch -----------------------------------------------------------------------

struct Steps {
    Stretch stretch;
    float step_m; // of equal ones
    uint count;
    float growth; // 1: they are equal
    uint span, end; // GROWS_BY_DEPTH: so many are one, up to `end`
};

Steps equal_steps(Stretch stretch, uint count)
{
    return Steps(stretch, (stretch.t1_m - stretch.t0_m) / float(count), count, 1.0, 1, ~0u);
}

Steps view_steps_of(Stretch stretch)
{
    Steps steps = equal_steps(stretch, frame.steps);
    steps.growth = frame.step_growth;
    return steps;
}

// How many steps are one behind an optical depth: as many whole ones as it says, so that they tile
// the ray as they would alone.
uint span_behind(float optical_depth)
{
    return uint(min(1.0 + frame.depth_growth * optical_depth, float(NEPH_GPU_SPAN_MAX)));
}

// The step after one.
uint step_after(Steps steps, uint i)
{
    return GROWS_BY_DEPTH ? min(i + steps.span, steps.end) : i + 1;
}

bool are_equal(Steps steps) { return !GROWS || own(steps.growth == 1.0); }

// Where a step that has grown begins: lengths in geometric progression.
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

// The point of a step, `place` (0..1) of its length from its start.
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

// A bit for each cell of frame.skip_lattice, x fastest, 32 to a word: whether some shape may have a
// density other than 0 in the cell and a hair around it, so that a point's rounding does not matter
// (renderer/skip_cells.c). In place of majorants, which a march has no other use for.
layout(std430, binding = 3) readonly buffer SkipCells {
    uint skip_cells[];
};

// At a place in cells; beyond the lattice all shapes end, and any answer is right.
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

// Go on to the first step whose point is not in an empty cell, or to `end`; whether any was passed.
// In a loop of its own: rays that have passed their empty steps do their full ones together.
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

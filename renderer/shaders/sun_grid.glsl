// SPDX-License-Identifier: MIT
//
// Whether solids hide the sun, from a grid across the sun (renderer/sun_grid.h): one read decides
// for most points. A cell has the height towards the sun up to which a solid surely hides the sun,
// and the height from which on none does.
#ifndef NEPH_SUN_GRID_GLSL
#define NEPH_SUN_GRID_GLSL

#include "media.glsl"

const bool HAS_SUN_GRID = (SCENE_KINDS & NEPH_GPU_SUN_GRID) != 0u;

// The grid is in the buffer of Horizon's textures, in front of them.
layout(std430, binding = 4) readonly buffer SunGridCells {
    vec2 sun_grid_cells[];
};

// Behind the limits of all cells, the boxes and balls that touch each (constants.h).
layout(std430, binding = 4) readonly buffer SunGridLists {
    uint sun_grid_lists[];
};

const uint SUN_UNSURE = 0u; // rays decide
const uint SUN_SEEN = 1u;   // no solid of the grid hides it
const uint SUN_HIDDEN = 2u;

const uint NO_CELL = 0xffffffffu; // the point is outside of the grid

uint sun_from_grid(vec3 point_m, out uint cell_index)
{
    SunGrid grid = frame.sun_grid;
    vec2 place = vec2(dot(point_m, grid.across_u), dot(point_m, grid.across_v)) +
                 grid.corner_cells;
    vec3 far_m = abs(point_m);
    cell_index = NO_CELL;
    if (max(far_m.x, max(far_m.y, far_m.z)) > grid.reach_m)
        return SUN_UNSURE;
    ivec2 cell = ivec2(floor(place));
    if (any(lessThan(cell, ivec2(0))) || any(greaterThanEqual(cell, ivec2(grid.size))))
        return SUN_SEEN;
    cell_index = uint(cell.y) * grid.size.x + uint(cell.x);
    vec2 limits_m = sun_grid_cells[grid.first + cell_index];
    float height_m = dot(point_m, to_sun()) + grid.height_m;
    return height_m >= limits_m.y ? SUN_SEEN : height_m <= limits_m.x ? SUN_HIDDEN : SUN_UNSURE;
}

// The solids of a cell, as a list of constants.h.
uint sun_grid_list(uint cell_index)
{
    return cell_index == NO_CELL ? NEPH_GPU_MANY_LISTED
                                 : sun_grid_lists[frame.sun_grid.first_listed + cell_index];
}

#endif

// SPDX-License-Identifier: MIT
//
// A voxel grid, trilinear by hand: samplers interpolate with 8-bit weights on some devices. The
// lattice comes with a layer of zeros on every side, so that no lookup has to test for the border.
// `grid_values[]` is declared by the shader that includes this file.
#ifndef NEPH_GRID_GLSL
#define NEPH_GRID_GLSL

#include "numbers.glsl"

struct Grid {
    vec3 origin_m; // of node (0, 0, 0), a node of the layer of zeros
    uint first;    // its place in grid_values[]
    vec3 nodes_per_m;
    uint padding;
    uvec3 size; // nodes, the layer of zeros included; each side >= 3
    uint padding_2;
};

// The eight nodes of a cell: those at its lower z face and those at its upper one, x fastest.
struct Cell {
    vec4 low, high;
};

Cell grid_cell(Grid grid, uvec3 cell)
{
    uint x = 1, y = grid.size.x, z = grid.size.x * grid.size.y;
    uint at = grid.first + cell.x + cell.y * y + cell.z * z;
    return Cell(vec4(grid_values[at], grid_values[at + x], grid_values[at + y],
                     grid_values[at + x + y]),
                vec4(grid_values[at + z], grid_values[at + x + z], grid_values[at + y + z],
                     grid_values[at + x + y + z]));
}

float cell_density(Cell cell, vec3 at)
{
    vec4 z = mix(cell.low, cell.high, at.z);
    vec2 y = mix(z.xy, z.zw, at.y);
    return mix(y.x, y.y, at.x);
}

// Density at a point, in the values' own unit. `precise`: the place in the cell is what floor() has
// left of this very number. A GPU that fuses the product into the subtraction takes the cell off an
// unrounded number, which lies below the face that it was rounded up to: a weight of -1e-6, and beside
// an empty node a density below zero.
float grid_density(Grid grid, vec3 point_m)
{
    precise vec3 at = (point_m - grid.origin_m) * grid.nodes_per_m;
    vec3 last = vec3(grid.size - 1);
    if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, last)))
        return 0.0;
    vec3 cell = min(floor(at), last - 1.0);
    precise vec3 in_cell = at - cell;
    return cell_density(grid_cell(grid, uvec3(cell)), in_cell);
}

// The integral of the density over t in [t0, t1] [m], cell by cell (J. Amanatides and A. Woo, 1987).
// Within a cell the density is a cubic in t, for which two-point Gauss is exact.
float grid_integral_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m; // nodes per metre of the ray
    vec3 start = (origin_m - grid.origin_m) * grid.nodes_per_m;
    vec3 last = vec3(grid.size - 1);
    bvec3 falls = lessThan(slope, vec3(0.0));
    bvec3 level = lessThan(abs(slope), vec3(1e-20));
    vec3 entry = clamp(start + t0_m * slope, vec3(0.0), last);
    // A start on a face belongs to the cell that the ray goes on into.
    vec3 cell = clamp(mix(floor(entry), ceil(entry) - 1.0, falls), vec3(0.0), last - 1.0);
    vec3 forward = mix(vec3(1.0), vec3(-1.0), falls);
    vec3 per_node_m = 1.0 / mix(slope, vec3(1.0), level);

    Sum sum = sum_zero();
    float t_m = t0_m;
    while (t_m < t1_m) {
        // Faces from the cell, not by adding up: rounding does not gather along the ray.
        vec3 face = cell + mix(vec3(1.0), vec3(0.0), falls);
        vec3 next_m = mix((face - start) * per_node_m, vec3(FAR_M), level);
        float exit_m = min(next_m.x, min(next_m.y, next_m.z));
        float end_m = min(exit_m, t1_m);
        if (end_m > t_m) {
            float middle_m = 0.5 * (t_m + end_m), offset_m = gauss * (end_m - t_m);
            Cell nodes = grid_cell(grid, uvec3(cell));
            vec3 a = clamp(start + (middle_m - offset_m) * slope - cell, vec3(0.0), vec3(1.0));
            vec3 b = clamp(start + (middle_m + offset_m) * slope - cell, vec3(0.0), vec3(1.0));
            sum_add(sum, vec4(0.5 * (end_m - t_m) *
                              (cell_density(nodes, a) + cell_density(nodes, b))));
            t_m = end_m;
        }
        bvec3 leaves = lessThanEqual(next_m, vec3(exit_m));
        cell += mix(vec3(0.0), forward, leaves);
        if (any(lessThan(cell, vec3(0.0))) || any(greaterThan(cell, last - 1.0)))
            break;
    }
    return sum.value.x;
}

#endif

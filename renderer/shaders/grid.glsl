// SPDX-License-Identifier: MIT
//
// A voxel grid, trilinear by hand: samplers interpolate with 8-bit weights on some devices. The
// lattice comes with a layer of zeros on every side, so that no lookup has to test for the border.
// Along an axis without end that layer is the lattice's other side: cells 1 to `period` of it are
// one period, and any other is one of these.
// `grid_values[]` is declared by the shader that includes this file.
#ifndef NEPH_GRID_GLSL
#define NEPH_GRID_GLSL

#include "numbers.glsl"

struct Grid {
    vec3 origin_m; // of node (0, 0, 0), a node of the layer of zeros
    uint first;    // its place in grid_values[]
    vec3 nodes_per_m;
    float full; // the largest density: what a texture has as 1 (grid_texture.glsl)
    uvec3 size; // nodes, the layer of zeros included; each side >= 3
    float padding;
    vec3 texel; // 1 / size: a node's share of a texture
    vec3 period; // nodes after which it repeats without end; 0: it ends
};

const bool ENDLESS = (TRAITS & NEPH_GPU_ENDLESS) != 0u; // some grid is, along some axis
const float CELLS_AWAY = 1e9; // more than there are

// A place in the lattice, or a cell of it, where its values are kept.
vec3 grid_wrapped(Grid grid, vec3 at)
{
    bvec3 repeats = greaterThan(grid.period, vec3(0.0));
    return ENDLESS ? mix(at, 1.0 + mod(at - 1.0, max(grid.period, vec3(1.0))), repeats) : at;
}

// The first and the last cell of a lattice of so many.
vec3 first_cell(Grid grid)
{
    return ENDLESS ? mix(vec3(0.0), vec3(-CELLS_AWAY), greaterThan(grid.period, vec3(0.0)))
                   : vec3(0.0);
}

vec3 last_cell(Grid grid)
{
    vec3 last = vec3(grid.size - 1) - 1.0;
    return ENDLESS ? mix(last, vec3(CELLS_AWAY), greaterThan(grid.period, vec3(0.0))) : last;
}

// Where a walk ends at the latest, `slope` being nodes per metre: it meets no more cells than that.
float walked_to_m(vec3 slope, float t0_m, float t1_m)
{
    return ENDLESS ? min(t1_m, t0_m + float(NEPH_GPU_ENDLESS_CELLS) / dot(abs(slope), vec3(1.0)))
                   : t1_m;
}

// The eight nodes of a cell: those at its lower z face and those at its upper one, x fastest.
struct Cell {
    vec4 low, high;
};

Cell grid_cell(Grid grid, uvec3 cell)
{
    uint x = 1, y = grid.size.x, z = grid.size.x * grid.size.y;
    uint at = grid.first + cell.x + cell.y * y + cell.z * z;
#ifdef SEES_GRID_TEXELS
    return Cell(vec4(grid_pair(at), grid_pair(at + y)),
                vec4(grid_pair(at + z), grid_pair(at + y + z)));
#else
    return Cell(vec4(grid_values[at], grid_values[at + x], grid_values[at + y],
                     grid_values[at + x + y]),
                vec4(grid_values[at + z], grid_values[at + x + z], grid_values[at + y + z],
                     grid_values[at + x + y + z]));
#endif
}

float cell_density(Cell cell, vec3 at)
{
    vec4 z = mix(cell.low, cell.high, at.z);
    vec2 y = mix(z.xy, z.zw, at.y);
    return mix(y.x, y.y, at.x);
}

// Density at a point, in the values' own unit. `precise`: the place in the cell is what floor() has
// left of this very number. A GPU that fuses the product into the subtraction takes the cell off
// an unrounded number, which lies below the face that it was rounded up to: a weight of -1e-6, and
// beside an empty node a density below zero.
float grid_density(Grid grid, vec3 point_m)
{
    precise vec3 unwrapped = (point_m - grid.origin_m) * grid.nodes_per_m;
    precise vec3 at = grid_wrapped(grid, unwrapped);
    vec3 last = vec3(grid.size - 1);
    bool is_within = all(greaterThanEqual(at, vec3(0.0))) && all(lessThanEqual(at, last));
    vec3 cell = clamp(floor(at), vec3(0.0), last - 1.0);
    precise vec3 in_cell = at - cell;
    float density = cell_density(grid_cell(grid, uvec3(cell)), in_cell);
    return is_within ? density : 0.0; // a return before would keep Mesa from unrolling who asks
}

// The integral of the density over t in [t0, t1] [m], cell by cell (J. Amanatides and A. Woo,
// 1987). Within a cell the density is a cubic in t, for which two-point Gauss is exact.
float grid_integral_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m; // nodes per metre of the ray
    vec3 start = (origin_m - grid.origin_m) * grid.nodes_per_m;
    vec3 first = first_cell(grid), last = last_cell(grid);
    bvec3 falls = lessThan(slope, vec3(0.0));
    bvec3 level = lessThan(abs(slope), vec3(1e-20));
    vec3 entry = clamp(start + t0_m * slope, first, last + 1.0);
    // A start on a face belongs to the cell that the ray goes on into.
    vec3 cell = clamp(mix(floor(entry), ceil(entry) - 1.0, falls), first, last);
    vec3 forward = mix(vec3(1.0), vec3(-1.0), falls);
    vec3 per_node_m = 1.0 / mix(slope, vec3(1.0), level);

    Sum sum = sum_zero();
    float t_m = t0_m;
    t1_m = walked_to_m(slope, t0_m, t1_m);
    while (t_m < t1_m) {
        // Faces from the cell, not by adding up: rounding does not gather along the ray.
        vec3 face = cell + mix(vec3(1.0), vec3(0.0), falls);
        vec3 next_m = mix((face - start) * per_node_m, vec3(FAR_M), level);
        float exit_m = min(next_m.x, min(next_m.y, next_m.z));
        float end_m = min(exit_m, t1_m);
        if (end_m > t_m) {
            float middle_m = 0.5 * (t_m + end_m), offset_m = gauss * (end_m - t_m);
            Cell nodes = grid_cell(grid, uvec3(grid_wrapped(grid, cell)));
            vec3 a = clamp(start + (middle_m - offset_m) * slope - cell, vec3(0.0), vec3(1.0));
            vec3 b = clamp(start + (middle_m + offset_m) * slope - cell, vec3(0.0), vec3(1.0));
            sum_add(sum, vec4(0.5 * (end_m - t_m) *
                              (cell_density(nodes, a) + cell_density(nodes, b))));
            t_m = end_m;
        }
        bvec3 leaves = lessThanEqual(next_m, vec3(exit_m));
        cell += mix(vec3(0.0), forward, leaves);
        if (any(lessThan(cell, first)) || any(greaterThan(cell, last)))
            break;
    }
    return sum.value.x;
}

// The place within a stretch over which the density is a cubic, given by its values at 0, 1/3, 2/3
// and 1, where the integral reaches `fraction` of that over all of it. Newton's method, held
// between bounds that bisection narrows.
float cubic_quantile(vec4 f, float fraction)
{
    float c1 = 0.5 * (-11.0 * f.x + 18.0 * f.y - 9.0 * f.z + 2.0 * f.w);
    float c2 = 4.5 * (2.0 * f.x - 5.0 * f.y + 4.0 * f.z - f.w);
    float c3 = 4.5 * (-f.x + 3.0 * f.y - 3.0 * f.z + f.w);
    float target = fraction * (f.x + c1 / 2.0 + c2 / 3.0 + c3 / 4.0);
    float low = 0.0, high = 1.0, s = fraction;
    for (int i = 0; i < 12; i++) {
        float integral = s * (f.x + s * (c1 / 2.0 + s * (c2 / 3.0 + s * (c3 / 4.0))));
        float density = f.x + s * (c1 + s * (c2 + s * c3));
        if (integral < target)
            low = s;
        else
            high = s;
        float newton = s - (integral - target) / max(density, 1e-30);
        s = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return s;
}

// The walk of grid_integral_m (grid.glsl), stopped in the cell where the integral passes `target`.
// The lattice is one that ends: with cells wrapped in this loop, lavapipe lost the corner of the
// last one, and the tracer was off by 0.8 % (renderer/spirv_loops.h).
float grid_free_path_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m,
                       float target)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m;
    vec3 start = (origin_m - grid.origin_m) * grid.nodes_per_m;
    vec3 last = vec3(grid.size - 2);
    vec3 side = vec3(greaterThanEqual(slope, vec3(0.0)));
    bvec3 level = lessThan(abs(slope), vec3(1e-20));
    vec3 per_slope = mix(1.0 / slope, vec3(0.0), level);
    vec3 cell = clamp(floor(start + t0_m * slope), vec3(0.0), last), corner = cell;
    float t_m = t0_m, end_m = t0_m, sum = 0.0, term = 0.0;
    Cell nodes = Cell(vec4(0.0), vec4(0.0));
    while (end_m < t1_m && sum + term < target && all(greaterThanEqual(cell, vec3(0.0))) &&
           all(lessThanEqual(cell, last))) {
        sum += term;
        t_m = end_m;
        vec3 faces_m = mix((cell + side - start) * per_slope, vec3(FAR_M), level);
        float exit_m = min(faces_m.x, min(faces_m.y, faces_m.z));
        end_m = max(t_m, min(exit_m, t1_m));
        corner = cell;
        nodes = grid_cell(grid, uvec3(cell));
        float middle_m = 0.5 * (t_m + end_m), offset_m = gauss * (end_m - t_m);
        vec3 a = clamp(start + (middle_m - offset_m) * slope - cell, vec3(0.0), vec3(1.0));
        vec3 b = clamp(start + (middle_m + offset_m) * slope - cell, vec3(0.0), vec3(1.0));
        term = 0.5 * (end_m - t_m) * (cell_density(nodes, a) + cell_density(nodes, b));
        cell += mix(vec3(0.0), 2.0 * side - 1.0, lessThanEqual(faces_m, vec3(exit_m)));
    }
    if (sum + term < target)
        return end_m;
    vec4 densities;
    for (int i = 0; i < 4; i++)
        densities[i] = cell_density(nodes, clamp(start + mix(t_m, end_m, float(i) / 3.0) * slope -
                                                     corner, vec3(0.0), vec3(1.0)));
    return mix(t_m, end_m,
               cubic_quantile(densities, clamp((target - sum) / max(term, 1e-30), 0.0, 1.0)));
}

// One of the eight nodes around a point, with the probability of its trilinear weight: its
// expectation is the trilinear value, and so is whatever is linear in it (the chance of a
// collision, the factor of ratio tracking), for one load instead of eight.
float grid_random_node(Grid grid, vec3 point_m, uvec2 bits)
{
    // 21 bits for each axis.
    uvec3 thirds = uvec3(bits >> 11, (bits.x & 0x7ffu) << 10 | bits.y & 0x3ffu);
    vec3 u = vec3(thirds) * exp2(-21.0);
    vec3 at = clamp(grid_wrapped(grid, (point_m - grid.origin_m) * grid.nodes_per_m), vec3(0.0),
                    vec3(grid.size - 1) * 0.9999999);
    uvec3 node = min(uvec3(at + u), grid.size - 1); // the sum may round up
    return grid_values[grid.first + node.x + grid.size.x * (node.y + grid.size.y * node.z)];
}

#endif

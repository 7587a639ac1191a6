// SPDX-License-Identifier: MIT
//
// A voxel grid: trilinear density, its exact integral along a ray, the free path to a given
// integral, and a stochastic one-node sample. The including shader declares `grid_values[]`.
//
// Interpolation is done in the shader, because samplers of some devices interpolate with 8-bit
// weights. The grid is stored with a layer of zeros on every side, so a lookup needs no border
// test:
//
//    0   0   0   0   0        node 0 of each axis belongs to the layer of zeros
//    0   v   v   v   0
//    0   v   v   v   0
//    0   0   0   0   0
//
// Along an endless axis this layer contains the nodes of the opposite side instead: cells 1 to
// `period` are one period, and every other cell is wrapped into it.
//
// If cells are constant, cell i is the box around node i, and places are shifted by half a cell.
#ifndef NEPH_GRID_GLSL
#define NEPH_GRID_GLSL

#include "numbers.glsl"

struct Grid {
    vec3 origin_m; // of node (0, 0, 0), in the layer of zeros
    uint first;    // index of node (0, 0, 0) in grid_values[]
    vec3 nodes_per_m;
    float full; // largest density: the value 1 in a texture (grid_texture.glsl)
    uvec3 size; // nodes with the layer of zeros; each side >= 3
    float padding;
    vec3 texel; // 1 / size: a node's extent in texture coordinates
    vec3 period; // nodes per repetition; 0: the grid ends along this axis
};

const bool ENDLESS = (TRAITS & NEPH_GPU_ENDLESS) != 0u; // a grid is endless along an axis
const bool CONSTANT_CELLS = (TRAITS & NEPH_GPU_CONSTANT_CELLS) != 0u;
const float CELLS_AWAY = 1e9; // bound for cells of endless axes: more than a ray crosses

// The place of a point in cells: cell i spans i to i + 1.
vec3 grid_place(Grid grid, vec3 point_m)
{
    vec3 at = (point_m - grid.origin_m) * grid.nodes_per_m;
    return CONSTANT_CELLS ? at + 0.5 : at;
}

// Number of cells along each axis.
vec3 grid_cell_count(Grid grid) { return vec3(CONSTANT_CELLS ? grid.size : grid.size - 1); }

// The stored place or cell that an unwrapped one repeats.
vec3 grid_wrapped(Grid grid, vec3 at)
{
    bvec3 repeats = greaterThan(grid.period, vec3(0.0));
    return ENDLESS ? mix(at, 1.0 + mod(at - 1.0, max(grid.period, vec3(1.0))), repeats) : at;
}

// Bounds of a walk in cells: the grid's own, or +-CELLS_AWAY along endless axes.
vec3 first_cell(Grid grid)
{
    return ENDLESS ? mix(vec3(0.0), vec3(-CELLS_AWAY), greaterThan(grid.period, vec3(0.0)))
                   : vec3(0.0);
}

vec3 last_cell(Grid grid)
{
    vec3 last = grid_cell_count(grid) - 1.0;
    return ENDLESS ? mix(last, vec3(CELLS_AWAY), greaterThan(grid.period, vec3(0.0))) : last;
}

// Upper end of a walk through an endless grid: it crosses at most NEPH_GPU_ENDLESS_CELLS cells.
// `slope` is in nodes per metre of the ray.
float walked_to_m(vec3 slope, float t0_m, float t1_m)
{
    return ENDLESS ? min(t1_m, t0_m + float(NEPH_GPU_ENDLESS_CELLS) / dot(abs(slope), vec3(1.0)))
                   : t1_m;
}

// The eight nodes of a cell, at its lower and its upper z face:
//
//    low.z --- low.w       x to the right, y upwards
//      |         |
//    low.x --- low.y
struct Cell {
    vec4 low, high;
};

Cell grid_cell(Grid grid, uvec3 cell)
{
    uint x = 1, y = grid.size.x, z = grid.size.x * grid.size.y;
    uint at = grid.first + cell.x + cell.y * y + cell.z * z;
    if (CONSTANT_CELLS)
        return Cell(vec4(grid_values[at]), vec4(grid_values[at]));
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

// Trilinear interpolation at a place 0..1 in the cell.
float cell_density(Cell cell, vec3 at)
{
    vec4 z = mix(cell.low, cell.high, at.z);
    vec2 y = mix(z.xy, z.zw, at.y);
    return mix(y.x, y.y, at.x);
}

// Density at a point, in the unit of the stored values.
//
// `precise` is required: the place in the cell must be the remainder of exactly the number that
// floor() has seen. A GPU that fuses the product into the subtraction subtracts the cell from an
// unrounded number, which can lie below the face that it was rounded up to. The weight becomes
// -1e-6, and next to an empty node the density becomes negative.
float grid_density(Grid grid, vec3 point_m)
{
    precise vec3 unwrapped = (point_m - grid.origin_m) * grid.nodes_per_m;
    if (CONSTANT_CELLS)
        unwrapped += 0.5;
    precise vec3 at = grid_wrapped(grid, unwrapped);
    vec3 last = grid_cell_count(grid);
    bool is_within = all(greaterThanEqual(at, vec3(0.0))) && all(lessThanEqual(at, last));
    vec3 cell = clamp(floor(at), vec3(0.0), last - 1.0);
    precise vec3 in_cell = at - cell;
    float density = cell_density(grid_cell(grid, uvec3(cell)), in_cell);
    return is_within ? density : 0.0; // an early return would keep Mesa from unrolling callers
}

// The integral of the density over t in [t0, t1] [m], cell by cell (J. Amanatides and A. Woo, "A
// Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987). Within a cell the density is
// a cubic in t, which two-point Gauss quadrature integrates exactly.
float grid_integral_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m; // nodes per metre of the ray
    vec3 start = grid_place(grid, origin_m);
    vec3 first = first_cell(grid), last = last_cell(grid);
    bvec3 falls = lessThan(slope, vec3(0.0));
    bvec3 level = lessThan(abs(slope), vec3(1e-20));
    vec3 entry = clamp(start + t0_m * slope, first, last + 1.0);
    // A start on a face belongs to the cell that the ray enters.
    vec3 cell = clamp(mix(floor(entry), ceil(entry) - 1.0, falls), first, last);
    vec3 forward = mix(vec3(1.0), vec3(-1.0), falls);
    vec3 per_node_m = 1.0 / mix(slope, vec3(1.0), level);

    Sum sum = sum_zero();
    float t_m = t0_m;
    t1_m = walked_to_m(slope, t0_m, t1_m);
    while (t_m < t1_m) {
        // Faces are computed from the cell index, so rounding errors do not accumulate along the
        // ray.
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

// The place s in 0..1 within a segment where the integral of the density reaches `fraction` of the
// whole. The density is a cubic, given by its values f at 0, 1/3, 2/3 and 1. Newton's method with
// bisection as a safeguard.
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

// The free path: the walk of grid_integral_m(), stopped in the cell where the integral passes
// `target`. Grids that end only: with wrapped cells in this loop lavapipe lost the corner of the
// last cell, and the tracer was off by 0.8 % (renderer/spirv_loops.h).
float grid_free_path_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m,
                       float target)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m;
    vec3 start = grid_place(grid, origin_m);
    vec3 last = grid_cell_count(grid) - 1.0;
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

// One of the eight nodes around a point, chosen with its trilinear weight as probability. Its
// expectation is the trilinear density, and so is the expectation of every linear function of it:
// the collision probability, the factor of ratio tracking. One load replaces eight. Constant cells:
// the node of the cell.
float grid_random_node(Grid grid, vec3 point_m, uvec2 bits)
{
    // 21 random bits per axis.
    uvec3 thirds = uvec3(bits >> 11, (bits.x & 0x7ffu) << 10 | bits.y & 0x3ffu);
    vec3 u = CONSTANT_CELLS ? vec3(0.5) : vec3(thirds) * exp2(-21.0);
    vec3 at = clamp(grid_wrapped(grid, (point_m - grid.origin_m) * grid.nodes_per_m), vec3(0.0),
                    vec3(grid.size - 1) * 0.9999999);
    uvec3 node = min(uvec3(at + u), grid.size - 1); // the sum may round up
    return grid_values[grid.first + node.x + grid.size.x * (node.y + grid.size.y * node.z)];
}

#endif

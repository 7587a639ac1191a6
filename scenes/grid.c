/* SPDX-License-Identifier: MIT */
#include "scenes/grid.h"

#include "scenes/media.h"

#include <math.h>
#include <stdlib.h>

enum neph_status neph_grid_create(const int size[3], struct neph_vec3 origin_m,
                                  struct neph_vec3 spacing_m, struct neph_grid **grid,
                                  struct neph_diag *diag)
{
    size_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] < 1 || size[axis] > NEPH_GRID_SIDE_MAX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "a grid of %d x %d x %d nodes: each side must be 1..%d", size[0],
                             size[1], size[2], NEPH_GRID_SIDE_MAX);
        count *= (size_t)size[axis];
    }
    if (count > NEPH_GRID_NODES_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "a grid of %d x %d x %d nodes is larger than %zu nodes", size[0], size[1],
                         size[2], NEPH_GRID_NODES_MAX);
    const bool placed = isfinite(origin_m.x) && isfinite(origin_m.y) && isfinite(origin_m.z);
    const bool spaced = spacing_m.x > 0.0 && spacing_m.y > 0.0 && spacing_m.z > 0.0 &&
                        isfinite(spacing_m.x) && isfinite(spacing_m.y) && isfinite(spacing_m.z);
    if (!placed || !spaced)
        return neph_fail(
            diag, NEPH_ERR_INPUT,
            "a grid at (%g, %g, %g) m with nodes (%g, %g, %g) m apart: must be finite, "
            "and the spacing above 0",
            origin_m.x, origin_m.y, origin_m.z, spacing_m.x, spacing_m.y, spacing_m.z);
    struct neph_grid *made = calloc(1, sizeof(*made));
    if (made)
        made->values = calloc(count, sizeof(*made->values));
    if (!made || !made->values) {
        free(made);
        return neph_fail_memory(diag);
    }
    for (int axis = 0; axis < 3; axis++)
        made->size[axis] = size[axis];
    made->origin_m = origin_m;
    made->spacing_m = spacing_m;
    *grid = made;
    return NEPH_OK;
}

static size_t node_count(const struct neph_grid *grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

enum neph_status neph_grid_seal(struct neph_grid *grid, struct neph_diag *diag)
{
    const size_t count = node_count(grid), nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    grid->maximum = 0.0f;
    for (size_t i = 0; i < count; i++) {
        const float value = grid->values[i];
        if (!isfinite(value) || value < 0.0f)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the density at node (%zu, %zu, %zu) is %g; it must be finite and not "
                             "negative",
                             i % nx, i / nx % ny, i / nx / ny, (double)value);
        grid->maximum = fmaxf(grid->maximum, value);
    }
    return neph_hash(grid->values, count * sizeof(*grid->values), grid->hash, diag);
}

void neph_grid_destroy(struct neph_grid *grid)
{
    if (!grid)
        return;
    free(grid->values);
    free(grid);
}

struct neph_bounds neph_grid_support(const struct neph_grid *grid)
{
    const struct neph_vec3 o = grid->origin_m, h = grid->spacing_m;
    return (struct neph_bounds){
        {o.x - h.x, o.y - h.y, o.z - h.z},
        {o.x + grid->size[0] * h.x, o.y + grid->size[1] * h.y, o.z + grid->size[2] * h.z}};
}

/* A node of the lattice that goes on with zeros. */
static double node(const struct neph_grid *grid, int i, int j, int k)
{
    if (i < 0 || j < 0 || k < 0 || i >= grid->size[0] || j >= grid->size[1] || k >= grid->size[2])
        return 0.0;
    const size_t nx = (size_t)grid->size[0], ny = (size_t)grid->size[1];
    return (double)grid->values[((size_t)k * ny + (size_t)j) * nx + (size_t)i];
}

static double mix(double a, double b, double s)
{
    return a + s * (b - a);
}

/* The eight nodes of the cell whose lowest corner is node (i, j, k), x fastest. */
static void load_cell(const struct neph_grid *grid, const int cell[3], double corners[8])
{
    for (int c = 0; c < 8; c++)
        corners[c] = node(grid, cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2));
}

/* Trilinear between eight corners; x, y, z in 0..1 within the cell. */
static double blend(const double corners[8], double x, double y, double z)
{
    const double low = mix(mix(corners[0], corners[1], x), mix(corners[2], corners[3], x), y);
    const double high = mix(mix(corners[4], corners[5], x), mix(corners[6], corners[7], x), y);
    return mix(low, high, z);
}

/* A point in units of nodes. */
static void to_lattice(const struct neph_grid *grid, struct neph_vec3 point_m, double at[3])
{
    at[0] = (point_m.x - grid->origin_m.x) / grid->spacing_m.x;
    at[1] = (point_m.y - grid->origin_m.y) / grid->spacing_m.y;
    at[2] = (point_m.z - grid->origin_m.z) / grid->spacing_m.z;
}

double neph_grid_density(const struct neph_grid *grid, struct neph_vec3 point_m)
{
    double at[3], corners[8];
    int cell[3];
    to_lattice(grid, point_m, at);
    for (int axis = 0; axis < 3; axis++) {
        if (!(at[axis] > -1.0 && at[axis] < grid->size[axis])) /* NaN is outside, too */
            return 0.0;
        cell[axis] = (int)floor(at[axis]);
    }
    load_cell(grid, cell, corners);
    return blend(corners, at[0] - cell[0], at[1] - cell[1], at[2] - cell[2]);
}

/* A ray in units of nodes, on its way through the cells. */
struct walk {
    double origin[3], direction[3]; /* per metre of the ray */
    int cell[3], step[3];
    double next_m[3], delta_m[3]; /* to the next face, and between faces, per axis */
};

static struct walk walk_start(const struct neph_grid *grid, struct neph_vec3 origin_m,
                              struct neph_vec3 direction, double t0_m)
{
    struct walk walk;
    to_lattice(grid, origin_m, walk.origin);
    walk.direction[0] = direction.x / grid->spacing_m.x;
    walk.direction[1] = direction.y / grid->spacing_m.y;
    walk.direction[2] = direction.z / grid->spacing_m.z;
    for (int axis = 0; axis < 3; axis++) {
        const double slope = walk.direction[axis];
        const double start = walk.origin[axis] + t0_m * slope;
        /* A start on a face belongs to the cell that the ray goes on into. */
        const double low = slope < 0.0 ? ceil(start) - 1.0 : floor(start);
        walk.cell[axis] = (int)fmax(-1.0, fmin(grid->size[axis] - 1.0, low));
        walk.step[axis] = slope < 0.0 ? -1 : 1;
        const double face = walk.cell[axis] + (slope < 0.0 ? 0.0 : 1.0);
        walk.next_m[axis] = slope == 0.0 ? INFINITY : (face - walk.origin[axis]) / slope;
        walk.delta_m[axis] = slope == 0.0 ? INFINITY : 1.0 / fabs(slope);
    }
    return walk;
}

/* Two-point Gauss: exact for the cubic that a trilinear function is along a line. */
static double integrate_cell_m(const struct neph_grid *grid, const struct walk *walk, double t0_m,
                               double t1_m)
{
    static const double offset = 0.288675134594812882254574390251; /* 1 / sqrt(12) */
    double corners[8], sum = 0.0;
    load_cell(grid, walk->cell, corners);
    const double middle_m = 0.5 * (t0_m + t1_m), length_m = t1_m - t0_m;
    for (int side = -1; side <= 1; side += 2) {
        const double t_m = middle_m + side * offset * length_m;
        double at[3];
        for (int axis = 0; axis < 3; axis++) {
            const double x = walk->origin[axis] + t_m * walk->direction[axis] - walk->cell[axis];
            at[axis] = fmax(0.0, fmin(1.0, x)); /* a rounding outside would extrapolate */
        }
        sum += blend(corners, at[0], at[1], at[2]);
    }
    return 0.5 * length_m * sum;
}

static int nearest_axis(const double next_m[3])
{
    const int xy = next_m[0] <= next_m[1] ? 0 : 1;
    return next_m[xy] <= next_m[2] ? xy : 2;
}

double neph_grid_integral_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_bounds support = neph_grid_support(grid);
    if (!neph_bounds_clip(&support, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    struct walk walk = walk_start(grid, origin_m, direction, t0_m);
    double sum_m = 0.0;
    while (t0_m < t1_m) {
        const int axis = nearest_axis(walk.next_m);
        const double end_m = fmin(walk.next_m[axis], t1_m);
        if (end_m > t0_m) {
            sum_m += integrate_cell_m(grid, &walk, t0_m, end_m);
            t0_m = end_m;
        }
        walk.cell[axis] += walk.step[axis];
        walk.next_m[axis] += walk.delta_m[axis];
        if (walk.cell[axis] < -1 || walk.cell[axis] >= grid->size[axis])
            break;
    }
    return fmax(sum_m, 0.0);
}

double neph_grid_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box)
{
    double low[3], high[3], maximum = 0.0;
    int first[3], last[3];
    to_lattice(grid, box->min_m, low);
    to_lattice(grid, box->max_m, high);
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = (int)fmax(0.0, fmin(floor(low[axis]), grid->size[axis]));
        last[axis] = (int)fmax(-1.0, fmin(ceil(high[axis]), grid->size[axis] - 1.0));
    }
    for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++)
            for (int i = first[0]; i <= last[0]; i++)
                maximum = fmax(maximum, node(grid, i, j, k));
    return maximum;
}

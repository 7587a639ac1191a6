/* SPDX-License-Identifier: MIT
 *
 * All geometry is done in lattice coordinates u = (x - origin) / spacing: node i is at u = i, cell
 * i spans [i, i + 1]. Cells -1 and size - 1 are the ramps to the zeros beyond the lattice.
 *
 * Along an endless axis the lattice repeats: indices of cells do not wrap, indices of values do.
 *
 * The density is continuous, so a ray along a face, or a place that rounding moves into the
 * neighbouring cell, needs no special case. Constant cells: cell i spans [i - 1/2, i + 1/2], and a
 * ray along a face, an event of probability 0 for random rays, belongs to the upper cell.
 */
#include "scenes/grid.h"

#include "scenes/bounds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct lattice_point {
    double u[3];
};

static struct lattice_point to_lattice(const struct neph_grid *grid, struct neph_vec3 point_m)
{
    return (struct lattice_point){{(point_m.x - grid->origin_m.x) / grid->spacing_m.x,
                                   (point_m.y - grid->origin_m.y) / grid->spacing_m.y,
                                   (point_m.z - grid->origin_m.z) / grid->spacing_m.z}};
}

static enum neph_status check_size(const int size[3], struct neph_diag *diag)
{
    for (int axis = 0; axis < 3; axis++)
        if (size[axis] < 1 || size[axis] > NEPH_GRID_SIDE_MAX)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "a grid of %d x %d x %d nodes: each side may have 1 to %d", size[0],
                             size[1], size[2], NEPH_GRID_SIDE_MAX);
    const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    if (count > NEPH_GRID_NODES_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "a grid of %d x %d x %d nodes needs %zu MiB; the most is %zu MiB", size[0],
                         size[1], size[2], count * sizeof(float) >> 20,
                         NEPH_GRID_NODES_MAX * sizeof(float) >> 20);
    return NEPH_OK;
}

/* Both ends of the support must be finite and different from the origin. */
static bool is_axis_valid(double origin_m, double spacing_m, int size)
{
    const double low_m = origin_m - spacing_m, high_m = origin_m + spacing_m * size;
    return spacing_m > 0.0 && isfinite(low_m) && isfinite(high_m) && low_m < origin_m &&
           origin_m < high_m;
}

static enum neph_status check_place(const int size[3], struct neph_vec3 origin_m,
                                    struct neph_vec3 spacing_m, struct neph_diag *diag)
{
    if (is_axis_valid(origin_m.x, spacing_m.x, size[0]) &&
        is_axis_valid(origin_m.y, spacing_m.y, size[1]) &&
        is_axis_valid(origin_m.z, spacing_m.z, size[2]))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "a grid with origin (%g, %g, %g) m and spacing (%g, %g, %g) m: both must be "
                     "finite, the spacing above 0 and not lost to rounding at the origin",
                     origin_m.x, origin_m.y, origin_m.z, spacing_m.x, spacing_m.y, spacing_m.z);
}

static size_t node_count(const struct neph_grid *grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

enum neph_status neph_grid_create(const int size[3], struct neph_vec3 origin_m,
                                  struct neph_vec3 spacing_m, struct neph_grid **grid,
                                  struct neph_diag *diag)
{
    enum neph_status status = check_size(size, diag);
    if (!status)
        status = check_place(size, origin_m, spacing_m, diag);
    if (status)
        return status;
    struct neph_grid *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    memcpy(made->size, size, sizeof(made->size));
    made->origin_m = origin_m;
    made->spacing_m = spacing_m;
    made->values = calloc(node_count(made), sizeof(*made->values));
    if (!made->values) {
        neph_grid_destroy(made);
        return neph_fail_memory(diag);
    }
    *grid = made;
    return NEPH_OK;
}

enum neph_status neph_grid_place(struct neph_grid *grid, struct neph_vec3 origin_m,
                                 struct neph_vec3 spacing_m, struct neph_diag *diag)
{
    enum neph_status status = check_place(grid->size, origin_m, spacing_m, diag);
    if (status)
        return status;
    grid->origin_m = origin_m;
    grid->spacing_m = spacing_m;
    return NEPH_OK;
}

void neph_grid_destroy(struct neph_grid *grid)
{
    if (!grid)
        return;
    free(grid->values);
    free(grid);
}

static enum neph_status check_value(const struct neph_grid *grid, size_t node,
                                    struct neph_diag *diag)
{
    const float value = grid->values[node];
    if (isfinite(value) && value >= 0.0f)
        return NEPH_OK;
    const size_t row = (size_t)grid->size[0], plane = row * (size_t)grid->size[1];
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "density %g at node (%zu, %zu, %zu) of a grid of %d x %d x %d: it must be "
                     "finite and not negative",
                     (double)value, node % row, node % plane / row, node / plane, grid->size[0],
                     grid->size[1], grid->size[2]);
}

/* Hashes the values in place, without a copy, and then their hash with the size. */
static enum neph_status hash_grid(const struct neph_grid *grid, char hash[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag)
{
    char values[NEPH_HASH_HEX_SIZE], text[NEPH_HASH_HEX_SIZE + 64];
    const enum neph_status status = neph_hash(
        grid->values, node_count(grid) * sizeof(*grid->values), values, diag);
    if (status)
        return status;
    const bool *endless = grid->is_endless;
    int length = snprintf(text, sizeof(text), "%d %d %d %s", grid->size[0], grid->size[1],
                          grid->size[2], values);
    if (neph_grid_is_endless(grid))
        length += snprintf(text + length, sizeof(text) - (size_t)length, " %d %d %d", endless[0],
                           endless[1], endless[2]);
    if (grid->is_constant)
        length += snprintf(text + length, sizeof(text) - (size_t)length, " constant");
    return neph_hash(text, (size_t)length, hash, diag);
}

enum neph_status neph_grid_seal(struct neph_grid *grid, struct neph_diag *diag)
{
    const size_t count = node_count(grid);
    float maximum = 0.0f;
    for (size_t node = 0; node < count; node++) {
        const float value = grid->values[node];
        if (value >= 0.0f && value <= maximum) /* nearly all values; false for NaN */
            continue;
        const enum neph_status status = check_value(grid, node, diag);
        if (status)
            return status;
        maximum = value;
    }
    const enum neph_status status = hash_grid(grid, grid->hash, diag);
    if (!status)
        grid->maximum = maximum;
    return status;
}

bool neph_grid_is_endless(const struct neph_grid *grid)
{
    return grid->is_endless[0] || grid->is_endless[1] || grid->is_endless[2];
}

int neph_grid_wrapped(const struct neph_grid *grid, int axis, int node)
{
    const int size = grid->size[axis], rest = node % size;
    return rest < 0 ? rest + size : rest;
}

static void extend_endless_axis(bool is_endless, double *low_m, double *high_m)
{
    if (!is_endless)
        return;
    *low_m = -NEPH_GRID_ENDLESS_M;
    *high_m = NEPH_GRID_ENDLESS_M;
}

struct neph_bounds neph_grid_support(const struct neph_grid *grid)
{
    const struct neph_vec3 o = grid->origin_m, s = grid->spacing_m;
    const double beyond = grid->is_constant ? 0.5 : 1.0; /* the outermost nodes */
    struct neph_bounds support = {neph_vec3_sub(o, neph_vec3_scale(s, beyond)),
                                  {o.x + s.x * (grid->size[0] - 1 + beyond),
                                   o.y + s.y * (grid->size[1] - 1 + beyond),
                                   o.z + s.z * (grid->size[2] - 1 + beyond)}};
    extend_endless_axis(grid->is_endless[0], &support.min_m.x, &support.max_m.x);
    extend_endless_axis(grid->is_endless[1], &support.min_m.y, &support.max_m.y);
    extend_endless_axis(grid->is_endless[2], &support.min_m.z, &support.max_m.z);
    return support;
}

static bool is_within(int index, int size)
{
    return (unsigned)index < (unsigned)size; /* a negative index becomes a huge one */
}

static double node_value(const struct neph_grid *grid, int i, int j, int k)
{
    i = grid->is_endless[0] ? neph_grid_wrapped(grid, 0, i) : i;
    j = grid->is_endless[1] ? neph_grid_wrapped(grid, 1, j) : j;
    k = grid->is_endless[2] ? neph_grid_wrapped(grid, 2, k) : k;
    if (!is_within(i, grid->size[0]) || !is_within(j, grid->size[1]) ||
        !is_within(k, grid->size[2]))
        return 0.0;
    return (double)
        grid->values[((size_t)k * (size_t)grid->size[1] + (size_t)j) * (size_t)grid->size[0] +
                     (size_t)i];
}

/* The eight corners of a cell, x fastest; constant cells have only an index. */
struct cell {
    int index[3];
    double corner[8];
    bool is_empty;
};

static void load_corners_inside(const struct neph_grid *grid, struct cell *cell)
{
    const size_t row = (size_t)grid->size[0], plane = row * (size_t)grid->size[1];
    const float *first = grid->values + (size_t)cell->index[2] * plane +
                         (size_t)cell->index[1] * row + (size_t)cell->index[0];
    for (size_t n = 0; n < 8; n++)
        cell->corner[n] = (double)first[(n & 1) + (n >> 1 & 1) * row + (n >> 2) * plane];
}

static void load_corners(const struct neph_grid *grid, struct cell *cell)
{
    const int *c = cell->index;
    if (is_within(c[0], grid->size[0] - 1) && is_within(c[1], grid->size[1] - 1) &&
        is_within(c[2], grid->size[2] - 1)) {
        load_corners_inside(grid, cell);
    } else {
        for (int n = 0; n < 8; n++)
            cell->corner[n] = node_value(grid, c[0] + (n & 1), c[1] + (n >> 1 & 1),
                                         c[2] + (n >> 2));
    }
    cell->is_empty = true;
    for (int n = 0; n < 8; n++)
        cell->is_empty = cell->is_empty && cell->corner[n] == 0.0;
}

/* Weights that are both >= 0: a + (b - a) f may be below 0 or, by cancellation, wrong. */
static double mix(double a, double b, double f)
{
    return a * (1.0 - f) + b * f;
}

/* Clamps to 0..1. fmin and fmax would be calls in the innermost loop, for their handling of NaN. */
static double clamp(double f)
{
    return f < 0.0 ? 0.0 : f > 1.0 ? 1.0 : f;
}

/* The density at a lattice point that lies in the cell, up to rounding. */
static double cell_density(const struct cell *cell, const double u[3])
{
    double f[3];
    for (int axis = 0; axis < 3; axis++)
        f[axis] = clamp(u[axis] - cell->index[axis]);
    const double *c = cell->corner;
    return mix(mix(mix(c[0], c[1], f[0]), mix(c[2], c[3], f[0]), f[1]),
               mix(mix(c[4], c[5], f[0]), mix(c[6], c[7], f[0]), f[1]), f[2]);
}

/* The density of constant cells; 0 outside, and for NaN. */
static double nearest_density(const struct neph_grid *grid, const double u[3])
{
    int node[3];
    for (int axis = 0; axis < 3; axis++) {
        const bool is_inside = u[axis] >= -0.5 && u[axis] < grid->size[axis] - 0.5;
        if (!is_inside && !(grid->is_endless[axis] && isfinite(u[axis])))
            return 0.0;
        node[axis] = (int)floor(u[axis] + 0.5);
    }
    return node_value(grid, node[0], node[1], node[2]);
}

static double lattice_density(const struct neph_grid *grid, const double u[3])
{
    struct cell cell;
    if (grid->is_constant)
        return nearest_density(grid, u);
    for (int axis = 0; axis < 3; axis++) {
        const bool is_inside = u[axis] > -1.0 && u[axis] < grid->size[axis];
        if (!is_inside && !(grid->is_endless[axis] && isfinite(u[axis]))) /* NaN is outside, too */
            return 0.0;
        cell.index[axis] = (int)floor(u[axis]);
    }
    load_corners(grid, &cell);
    return cell_density(&cell, u);
}

double neph_grid_density(const struct neph_grid *grid, struct neph_vec3 point_m)
{
    const struct lattice_point point = to_lattice(grid, point_m);
    return lattice_density(grid, point.u);
}

/* A ray in lattice coordinates, start + t step, and its present cell. */
struct walk {
    double start[3], step[3];
    double next_t[3]; /* where the ray meets the next face across each axis */
    struct cell cell;
};

static void find_next_face(struct walk *walk, int axis)
{
    const int face = walk->cell.index[axis] + (walk->step[axis] > 0.0 ? 1 : 0);
    walk->next_t[axis] = walk->step[axis] == 0.0 ? INFINITY
                                                 : (face - walk->start[axis]) / walk->step[axis];
}

/* t = 0 is the place `from_m`, which lies in the support up to rounding. */
static void start_walk(struct walk *walk, const struct neph_grid *grid, struct neph_vec3 from_m,
                       struct neph_vec3 direction)
{
    const struct lattice_point start = to_lattice(grid, from_m);
    const double step[3] = {direction.x / grid->spacing_m.x, direction.y / grid->spacing_m.y,
                            direction.z / grid->spacing_m.z};
    const double shift = grid->is_constant ? 0.5 : 0.0; /* cell i then spans [i, i + 1] */
    for (int axis = 0; axis < 3; axis++) {
        walk->start[axis] = start.u[axis] + shift;
        walk->step[axis] = step[axis];
        const double last = grid->size[axis] - 1, cell = floor(walk->start[axis]);
        walk->cell.index[axis] = (int)(grid->is_endless[axis] ? cell
                                                              : fmin(last, fmax(-1.0, cell)));
        find_next_face(walk, axis);
    }
}

static int nearest_axis(const struct walk *walk)
{
    const double *t = walk->next_t;
    if (t[0] <= t[1])
        return t[0] <= t[2] ? 0 : 2;
    return t[1] <= t[2] ? 1 : 2;
}

/* Passes through the nearest face; false when that leaves the support. */
static bool advance(struct walk *walk, const struct neph_grid *grid)
{
    const int axis = nearest_axis(walk);
    int *index = &walk->cell.index[axis];
    *index += walk->step[axis] > 0.0 ? 1 : -1;
    find_next_face(walk, axis);
    return grid->is_endless[axis] || (*index >= -1 && *index < grid->size[axis]);
}

/* Two-point Gauss over [t0, t1] within the cell: exact for cubics. */
static double cell_integral(const struct walk *walk, double t0, double t1)
{
    static const double gauss_node = 0.577350269189625764509148780502; /* 1 / sqrt 3 */
    const double middle = 0.5 * (t0 + t1), half = 0.5 * (t1 - t0);
    double sum = 0.0;
    for (int side = -1; side <= 1; side += 2) {
        const double t = middle + side * half * gauss_node;
        double u[3];
        for (int axis = 0; axis < 3; axis++)
            u[axis] = walk->start[axis] + t * walk->step[axis];
        sum += cell_density(&walk->cell, u);
    }
    return half * sum;
}

/* Follows constant cells until the integral from t0_m reaches `target_m`. `*at_m` receives that
 * distance, +inf without one; returns the integral up to there. */
static double cross_constant_cells(const struct neph_grid *grid, struct neph_vec3 origin_m,
                                   struct neph_vec3 direction, double t0_m, double t1_m,
                                   double target_m, double *at_m)
{
    const struct neph_bounds support = neph_grid_support(grid);
    *at_m = INFINITY;
    if (!neph_bounds_clip(&support, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    struct walk walk;
    start_walk(&walk, grid, neph_vec3_along(origin_m, direction, t0_m), direction);
    const double end = t1_m - t0_m;
    double t = 0.0, sum_m = 0.0;
    do {
        const double next = walk.next_t[nearest_axis(&walk)], face = next < end ? next : end;
        if (face <= t)
            continue; /* a corner, or a start in a face */
        const int *cell = walk.cell.index;
        const double density = node_value(grid, cell[0], cell[1], cell[2]);
        if (density * (face - t) >= target_m - sum_m && density > 0.0) {
            *at_m = t0_m + fmin(face, t + (target_m - sum_m) / density);
            return target_m;
        }
        sum_m += density * (face - t);
        t = face;
    } while (t < end && advance(&walk, grid));
    return sum_m;
}

double neph_grid_free_path_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                             struct neph_vec3 direction, double t0_m, double t1_m,
                             double integral_m)
{
    double at_m;
    cross_constant_cells(grid, origin_m, direction, t0_m, t1_m, integral_m, &at_m);
    return at_m;
}

double neph_grid_integral_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    double at_m;
    if (grid->is_constant)
        return cross_constant_cells(grid, origin_m, direction, t0_m, t1_m, INFINITY, &at_m);
    const struct neph_bounds support = neph_grid_support(grid);
    if (!neph_bounds_clip(&support, origin_m, direction, &t0_m, &t1_m))
        return 0.0;
    /* Start at the entry: a distant origin would round the places of the faces. */
    struct walk walk;
    start_walk(&walk, grid, neph_vec3_along(origin_m, direction, t0_m), direction);
    const double end = t1_m - t0_m;
    double t = 0.0, sum_m = 0.0;
    do {
        const double next = walk.next_t[nearest_axis(&walk)], face = next < end ? next : end;
        if (face <= t)
            continue; /* a corner, or a start in a face */
        load_corners(grid, &walk.cell);
        if (!walk.cell.is_empty)
            sum_m += cell_integral(&walk, t, face);
        t = face;
    } while (t < end && advance(&walk, grid));
    return sum_m;
}

/* An interval on one axis and the nodes around it. */
struct stretch {
    double low, high;
    int first, last; /* first <= low, high <= last */
};

/* Along an endless axis at most one period is searched. */
static bool find_stretch(double low, double high, int size, bool is_endless,
                         struct stretch *stretch)
{
    if (is_endless ? !(low <= high) : !(low <= high && high > -1.0 && low < size))
        return false;
    stretch->low = is_endless ? (high - low < size ? low - size * floor(low / size) : 0.0)
                              : fmax(-1.0, low);
    stretch->high = is_endless ? stretch->low + fmin(size, high - low) : fmin(size, high);
    stretch->first = (int)floor(stretch->low);
    stretch->last = (int)ceil(stretch->high);
    return true;
}

/* Node i, clamped to the interval. */
static double place_in(const struct stretch *stretch, int i)
{
    return fmin(stretch->high, fmax(stretch->low, i));
}

/* Maximum along x at the given y and z. */
static double row_maximum(const struct neph_grid *grid, const struct stretch *x, double v, double w)
{
    const double low[3] = {x->low, v, w}, high[3] = {x->high, v, w};
    double maximum = fmax(lattice_density(grid, low), lattice_density(grid, high));
    const bool is_on_nodes = v == floor(v) && w == floor(w); /* mostly true in a large box */
    for (int i = x->first + 1; i < x->last; i++) {
        const double at[3] = {i, v, w};
        const double density = is_on_nodes ? node_value(grid, i, (int)v, (int)w)
                                           : lattice_density(grid, at);
        maximum = fmax(maximum, density);
    }
    return maximum;
}

/* In each cell a trilinear function is largest at a corner of the cell's intersection with the
 * box. */
double neph_grid_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box)
{
    if (grid->is_constant) /* at most a cell more than the box */
        return neph_grid_node_maximum_in(grid, box);
    const struct lattice_point low = to_lattice(grid, box->min_m);
    const struct lattice_point high = to_lattice(grid, box->max_m);
    struct stretch stretch[3];
    for (int axis = 0; axis < 3; axis++)
        if (!find_stretch(low.u[axis], high.u[axis], grid->size[axis], grid->is_endless[axis],
                          &stretch[axis]))
            return 0.0;
    double maximum = 0.0;
    for (int k = stretch[2].first; k <= stretch[2].last; k++)
        for (int j = stretch[1].first; j <= stretch[1].last; j++)
            maximum = fmax(maximum, row_maximum(grid, &stretch[0], place_in(&stretch[1], j),
                                                place_in(&stretch[2], k)));
    return maximum;
}

double neph_grid_node_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box)
{
    const double touch = 1e-6; /* a box that ends in a face does not overlap the cells beyond it */
    const struct lattice_point low = to_lattice(grid, box->min_m);
    const struct lattice_point high = to_lattice(grid, box->max_m);
    int first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        const double near = floor(low.u[axis] + touch), far = ceil(high.u[axis] - touch);
        const bool is_part = grid->is_endless[axis] && far - near < grid->size[axis];
        first[axis] = (int)(is_part ? near : fmax(0.0, near));
        last[axis] = (int)(is_part ? far : fmin(grid->size[axis] - 1, far));
        if (grid->is_endless[axis] && !is_part) {
            first[axis] = 0;
            last[axis] = grid->size[axis] - 1;
        }
    }
    double maximum = 0.0;
    for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++)
            for (int i = first[0]; i <= last[0]; i++)
                maximum = fmax(maximum, node_value(grid, i, j, k));
    return maximum;
}

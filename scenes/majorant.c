/* SPDX-License-Identifier: MIT */
#include "scenes/majorant.h"

#include "scenes/grid.h"
#include "scenes/media.h"

#include <math.h>
#include <stdlib.h>

/* The side of cubes of which `cell_count` fill the box. A side of the box that is shorter than a
 * cube gets one cell; the other sides are then computed again with all cells. */
static double cube_side_m(const double extent_m[3], int cell_count)
{
    double side_m = INFINITY;
    bool is_thin[3] = {false, false, false};
    for (int round = 0; round < 3; round++) {
        double product = 1.0 / cell_count;
        int count = 0;
        for (int axis = 0; axis < 3; axis++)
            if (!is_thin[axis]) {
                product *= extent_m[axis];
                count++;
            }
        if (count == 0)
            break;
        side_m = pow(product, 1.0 / count);
        for (int axis = 0; axis < 3; axis++)
            is_thin[axis] = extent_m[axis] < side_m;
    }
    return side_m;
}

static void choose_size(const struct neph_medium *medium, const double extent_m[3], int cell_count,
                        int size[3])
{
    const double side_m = cube_side_m(extent_m, cell_count);
    double thinnest_m[3] = {0.0, 0.0, 0.0};
    if (medium->grid) {
        thinnest_m[0] = medium->grid->spacing_m.x;
        thinnest_m[1] = medium->grid->spacing_m.y;
        thinnest_m[2] = medium->grid->spacing_m.z;
    }
    for (int axis = 0; axis < 3; axis++) {
        double cells = fmin(NEPH_GRID_SIDE_MAX, round(extent_m[axis] / side_m));
        if (thinnest_m[axis] > 0.0) /* the tolerance keeps whole cells whole despite rounding */
            cells = fmin(cells, floor(extent_m[axis] / thinnest_m[axis] + 1e-6));
        size[axis] = (int)fmax(1.0, cells);
    }
}

/* Majorants cover a margin beyond the cell, because a tracker's rounding may put a point of the
 * face into either neighbour. In float32 it is 1e-3 of a cell where the coordinates are 10^4
 * cells. */
static const double hair = 1e-3;

/* A cell, extended by `margin` of its sides on all sides. */
static struct neph_bounds cell_box(const struct neph_majorants *majorants, const int cell[3],
                                   double margin)
{
    const double low[3] = {majorants->box.min_m.x, majorants->box.min_m.y, majorants->box.min_m.z};
    const double high[3] = {majorants->box.max_m.x, majorants->box.max_m.y, majorants->box.max_m.z};
    double a[3], b[3];
    for (int axis = 0; axis < 3; axis++) {
        const double side = (high[axis] - low[axis]) / majorants->size[axis];
        a[axis] = low[axis] + (cell[axis] - margin) * side;
        b[axis] = low[axis] + (cell[axis] + 1 + margin) * side;
    }
    return (struct neph_bounds){{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

/* Trackers evaluate the density in float32, which may round above the bound. */
static float rounded_up(double bound_per_m)
{
    return bound_per_m > 0.0 ? nextafterf((float)(bound_per_m * (1.0 + 1e-5)), INFINITY) : 0.0f;
}

static void fill(struct neph_majorants *majorants, const struct neph_medium *medium)
{
    const int *n = majorants->size;
    size_t at = 0;
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++) {
                const struct neph_bounds box = cell_box(majorants, (const int[3]){i, j, k}, hair);
                majorants->extinction_per_m[at++] = rounded_up(
                    neph_medium_extinction_bound_per_m(medium, &box));
            }
}

enum neph_status neph_majorants_create(const struct neph_medium *medium,
                                       const struct neph_bounds *box, int cell_count,
                                       struct neph_majorants **majorants, struct neph_diag *diag)
{
    const double extent_m[3] = {box->max_m.x - box->min_m.x, box->max_m.y - box->min_m.y,
                                box->max_m.z - box->min_m.z};
    if (cell_count < 1)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a majorant grid of %d cells", cell_count);
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(extent_m[axis]))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "a %s without finite bounds has no majorant grid",
                             neph_medium_facts(medium->kind)->name);
        if (!(extent_m[axis] > 0.0))
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "the bounds of a %s exclude all of it: no majorant grid",
                             neph_medium_facts(medium->kind)->name);
    }
    struct neph_majorants *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->box = *box;
    choose_size(medium, extent_m, cell_count, made->size);
    const size_t count = (size_t)made->size[0] * (size_t)made->size[1] * (size_t)made->size[2];
    made->extinction_per_m = malloc(count * sizeof(*made->extinction_per_m));
    if (!made->extinction_per_m) {
        free(made);
        return neph_fail_memory(diag);
    }
    fill(made, medium);
    *majorants = made;
    return NEPH_OK;
}

/* Without the margin: a node beyond the face has a negligible weight there, and where the cells are
 * the grid's own the margin would include all nodes of the cells around. */
void neph_majorants_cover_nodes(struct neph_majorants *majorants, const struct neph_medium *medium)
{
    if (!medium->grid)
        return;
    float *majorant_per_m = majorants->extinction_per_m;
    const int *n = majorants->size;
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int i = 0; i < n[0]; i++, majorant_per_m++) {
                const struct neph_bounds box = cell_box(majorants, (const int[3]){i, j, k}, 0.0);
                const double bound_per_m = medium->extinction_per_m *
                                           neph_grid_node_maximum_in(medium->grid, &box);
                *majorant_per_m = fmaxf(*majorant_per_m, rounded_up(bound_per_m));
            }
}

void neph_majorants_destroy(struct neph_majorants *majorants)
{
    if (!majorants)
        return;
    free(majorants->extinction_per_m);
    free(majorants);
}

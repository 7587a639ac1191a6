/* SPDX-License-Identifier: MIT */
#include "scenes/column.h"

#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/solids.h"

#include <math.h>

/* A place on a face of turned bounds, by a hair off it, so that rounding does not put it outside.
 * The middle for a place outside. */
static struct neph_vec3 move_inside(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    static const double hair = 1e-9; /* of a side */
    const struct neph_bounds *box = &medium->box;
    const struct neph_vec3 middle_m = neph_bounds_middle(box);
    struct neph_vec3 own_m = neph_medium_own_point_m(medium, point_m);
    for (int axis = 0; axis < 3; axis++) {
        const double low_m = (&box->min_m.x)[axis], high_m = (&box->max_m.x)[axis];
        const double hair_m = hair * (high_m - low_m);
        double *place_m = &(&own_m.x)[axis];
        if (*place_m < low_m - hair_m || *place_m > high_m + hair_m)
            return middle_m;
        *place_m = fmax(low_m + hair_m, fmin(high_m - hair_m, *place_m));
    }
    return neph_vec3_add(middle_m, neph_rotate(&medium->turn, neph_vec3_sub(own_m, middle_m)));
}

double neph_medium_column_optical_depth(const struct neph_medium *medium, int axis)
{
    static const struct neph_vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct neph_medium_row *row = neph_medium_row(medium->kind);
    if (!row->column)
        return NAN;
    struct neph_column column = row->column(medium, axis);
    if (column.is_endless)
        return INFINITY;
    if (neph_is_turned(&medium->turn) && !column.begins_there)
        column.point_m = move_inside(medium, column.point_m);
    const double up = neph_medium_optical_depth(medium, column.point_m, axes[axis], 0.0, INFINITY);
    if (column.begins_there)
        return up;
    return up + neph_medium_optical_depth(medium, column.point_m, neph_vec3_scale(axes[axis], -1.0),
                                          0.0, INFINITY);
}

struct neph_medium neph_medium_of_layer(const struct neph_medium *medium, int layer)
{
    struct neph_medium one = *medium;
    one.layer_count = 1;
    one.layers[0] = medium->layers[layer];
    one.droplets[0] = medium->droplets[layer];
    return one;
}

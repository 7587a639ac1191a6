/* SPDX-License-Identifier: MIT */
#include "scenes/column.h"

#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/solids.h"

#include <math.h>

double neph_medium_column_optical_depth(const struct neph_medium *medium, int axis)
{
    static const struct neph_vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const struct neph_medium_row *row = neph_medium_row(medium->kind);
    if (!row->column)
        return NAN;
    struct neph_column column = row->column(medium, axis);
    if (column.is_endless)
        return INFINITY;
    if (neph_is_turned(&medium->turn) && !column.begins_there &&
        !neph_medium_contains(medium, column.point_m))
        column.point_m = neph_vec3_scale(neph_vec3_add(medium->box.min_m, medium->box.max_m), 0.5);
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

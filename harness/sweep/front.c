/* SPDX-License-Identifier: MIT
 *
 * Pareto fronts.
 */
#include "harness/sweep/front.h"

#include <math.h>

static bool has_all_values(const struct neph_front_point *point, int axis_count)
{
    for (int a = 0; a < axis_count; a++)
        if (isnan(point->values[a]))
            return false;
    return true;
}

static bool dominates_point(const struct neph_front_point *a, const struct neph_front_point *b,
                            int axis_count)
{
    bool is_less = false;
    for (int i = 0; i < axis_count; i++) {
        if (!(a->values[i] <= b->values[i])) /* also false for NaN */
            return false;
        is_less |= a->values[i] < b->values[i];
    }
    return is_less;
}

void neph_front_find(struct neph_front_point *points, int count, int axis_count)
{
    for (int i = 0; i < count; i++) {
        points[i].on_front = has_all_values(&points[i], axis_count);
        for (int k = 0; k < count && points[i].on_front; k++)
            points[i].on_front = !dominates_point(&points[k], &points[i], axis_count);
    }
}

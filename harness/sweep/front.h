/* SPDX-License-Identifier: MIT
 *
 * Pareto fronts: the points that are not dominated by any other.
 */
#ifndef NEPH_HARNESS_SWEEP_FRONT_H
#define NEPH_HARNESS_SWEEP_FRONT_H

#include <stdbool.h>

enum { NEPH_FRONT_AXES_MAX = 6 };

/* The values of a point; smaller is better. */
struct neph_front_point {
    double values[NEPH_FRONT_AXES_MAX]; /* a point with a NaN among the values in use is not on the
                                           front */
    bool on_front;
};

/* Marks the Pareto front in the first `axis_count` values. A point is on it unless another point is
 * at most as large in each value and smaller in one. Equal points are all on it. */
void neph_front_find(struct neph_front_point *points, int count, int axis_count);

#endif

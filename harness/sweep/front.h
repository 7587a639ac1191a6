/* SPDX-License-Identifier: MIT
 *
 * What cannot be beaten in one number without losing in another.
 */
#ifndef NEPH_HARNESS_SWEEP_FRONT_H
#define NEPH_HARNESS_SWEEP_FRONT_H

#include <stdbool.h>

enum { NEPH_FRONT_AXES_MAX = 6 };

/* A point by its numbers, of which less is better. */
struct neph_front_point {
    double values[NEPH_FRONT_AXES_MAX]; /* a NaN among those looked at: the point takes no part */
    bool on_front;
};

/* Mark the Pareto front by the first `axis_count` values: no other point is at most as large in
 * each and less in one. Of equal points all are on it. */
void neph_front_find(struct neph_front_point *points, int count, int axis_count);

#endif

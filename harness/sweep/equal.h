/* SPDX-License-Identifier: MIT
 *
 * Series held against each other where they are as good, or as fast.
 */
#ifndef NEPH_HARNESS_SWEEP_EQUAL_H
#define NEPH_HARNESS_SWEEP_EQUAL_H

#include "harness/sweep/results.h"

/* What a series needs where another is. */
struct neph_sweep_equal {
    const struct neph_sweep_series *series;
    double time_ratio;  /* its time over the other's at the same error; NaN: it never gets there, or
                           begins beyond it */
    double error_ratio; /* its error over the other's in the same time; NaN likewise */
    double at_error, at_s; /* of the other: the point of its least error */
};

/* Each series with times against `base`, at the point of least error of that series. Between points
 * of `base` log error is linear in log time; beyond them nothing is said. `list` has room for
 * NEPH_SWEEP_SERIES_MAX; the number of entries is returned. */
int neph_sweep_equals(const struct neph_sweep *sweep, const struct neph_sweep_series *base,
                      struct neph_sweep_equal *list);

/* A value of y at x on the polyline of the points by their x, all in logarithms; NaN outside. */
double neph_sweep_between(const double *x, const double *y, int count, double at);

#endif

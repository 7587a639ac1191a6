/* SPDX-License-Identifier: MIT
 *
 * Series held against each other where they are as good, or as dear.
 */
#ifndef NEPH_HARNESS_SWEEP_EQUAL_H
#define NEPH_HARNESS_SWEEP_EQUAL_H

#include "harness/json.h"
#include "harness/sweep/results.h"

/* What a point costs: on one device, or on any. */
enum neph_sweep_cost {
    NEPH_SWEEP_COST_TIME, /* median of a picture [s] */
    NEPH_SWEEP_COST_WORK, /* evaluations of density for a pixel */
    NEPH_SWEEP_COSTS,
};

/* NaN: not measured. */
double neph_sweep_cost_of(const struct neph_sweep_point *point, enum neph_sweep_cost cost);

/* What a series needs where another is. */
struct neph_sweep_equal {
    const struct neph_sweep_series *series;
    double cost_ratio;   /* its cost over the other's at the same number; NaN: the other has no such
                            number between two of its points */
    double number_ratio; /* its number over the other's at the same cost; NaN likewise */
    double at_number, at_cost; /* of the series: the best of its points of which most can be said */
};

/* Each series with that cost and number against `base`: at the point of least number among those
 * that both ratios can be said of, else one of them, else none. Between points of `base` the
 * logarithm of one is linear in that of the other; beyond them nothing is said, so that a single
 * point of `base` is held against what costs as much. `list` has room for NEPH_SWEEP_SERIES_MAX;
 * the number of entries is returned. */
int neph_sweep_equals(const struct neph_sweep *sweep, const struct neph_sweep_series *base,
                      enum neph_sweep_cost cost, enum neph_sweep_number number,
                      struct neph_sweep_equal *list);

/* A value of y at x on the polyline of the points by their x, all in logarithms; NaN outside. */
double neph_sweep_between(const double *x, const double *y, int count, double at);

/* A table for each cost and number in which something can be held against sweep->against (NULL: the
 * first series of which that is so). What the machines are, where they differ, stands below. */
void neph_sweep_print_equals(const struct neph_sweep *sweep, FILE *out);

/* [{"cost": "seconds" | "evaluations", "number": "error", "against", "series", "at_cost",
 * "at_number", "cost_ratio", "number_ratio"}, ...], null for "beyond"; for the caller. */
json_t *neph_sweep_equals_json(const struct neph_sweep *sweep);

#endif

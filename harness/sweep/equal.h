/* SPDX-License-Identifier: MIT
 *
 * Compares series at equal quality, and at equal cost.
 */
#ifndef NEPH_HARNESS_SWEEP_EQUAL_H
#define NEPH_HARNESS_SWEEP_EQUAL_H

#include "harness/json.h"
#include "harness/sweep/results.h"

/* Costs of a point: time on one device, or work on any. */
enum neph_sweep_cost {
    NEPH_SWEEP_COST_TIME, /* median time of a frame [s] */
    NEPH_SWEEP_COST_WORK, /* density evaluations per pixel */
    NEPH_SWEEP_COSTS,
};

/* NaN: not measured. */
double neph_sweep_point_cost(const struct neph_sweep_point *point, enum neph_sweep_cost cost);

/* A series relative to a base series. */
struct neph_sweep_comparison {
    const struct neph_sweep_series *series;
    double cost_ratio;   /* cost over the base's cost at the same value; NaN: no two points of the
                            base enclose the value */
    double number_ratio; /* value over the base's value at the same cost; NaN: no two points of the
                            base enclose the cost */
    double at_number, at_cost; /* the compared point: the best one among those with the most defined
                                  ratios */
};

/* Compares every series that has this cost and value with `base`. The compared point of a series is
 * the one with the smallest value for which both ratios are defined, else one of them, else none.
 * Between points of `base` the logarithms are interpolated linearly; nothing is extrapolated, so a
 * single point of `base` is only compared at exactly its value or cost. `list` has room for
 * NEPH_SWEEP_SERIES_MAX. Returns the number of entries. */
int neph_sweep_compare_series(const struct neph_sweep *sweep, const struct neph_sweep_series *base,
                              enum neph_sweep_cost cost, enum neph_sweep_number number,
                              struct neph_sweep_comparison *list);

/* y at x = `at` on the polyline through the points sorted by x, in logarithms; NaN outside. */
double neph_sweep_interpolate(const double *x, const double *y, int count, double at);

/* Prints a table for each cost and value that can be compared with sweep->against (NULL: the first
 * series with a comparison), and the devices where they differ. */
void neph_sweep_print_equals(const struct neph_sweep *sweep, FILE *out);

/* [{"cost": "seconds" | "evaluations", "number": "error", "against", "series", "at_cost",
 * "at_number", "cost_ratio", "number_ratio"}, ...], with null for "beyond"; for json_decref(). */
json_t *neph_sweep_equals_json(const struct neph_sweep *sweep);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Whether a Pareto front is reproducible: compares sweeps of the same plan with different seeds,
 * each in its own store.
 */
#ifndef NEPH_HARNESS_SWEEP_STABILITY_H
#define NEPH_HARNESS_SWEEP_STABILITY_H

#include "harness/sweep/equal.h"

/* Outcome of a point over all sweeps. */
enum neph_stability_outcome {
    NEPH_STABILITY_ABSENT, /* not measured in one of the sweeps */
    NEPH_STABILITY_OFF,    /* on no front */
    NEPH_STABILITY_ON,     /* on all fronts */
    NEPH_STABILITY_WITHIN, /* on some fronts; where it is not, no point dominates it beyond the
                              intervals of cost and value */
    NEPH_STABILITY_MOVED,  /* on some fronts, and dominated beyond the intervals in a sweep */
    NEPH_STABILITY_OUTCOMES,
};
extern const char *const neph_stability_words[NEPH_STABILITY_OUTCOMES];

/* Whether `a` dominates `b` for all values within their intervals: cost and value are at most
 * equal, and one is smaller. A value without an interval counts as exact. */
bool neph_stability_dominates(const struct neph_sweep_point *a, const struct neph_sweep_point *b,
                              enum neph_sweep_cost cost, enum neph_sweep_number number);

/* The outcome of a point, by index, in `count` sweeps of one plan. */
enum neph_stability_outcome neph_stability_judge(const struct neph_sweep *sweeps, int count,
                                                 int point, enum neph_sweep_cost cost,
                                                 enum neph_sweep_number number);

/* Largest distance of a point from the fronts: the relative reduction of cost or value, whichever
 * is smaller, that would put it on the front. 0: on all fronts. */
double neph_stability_front_distance(const struct neph_sweep *sweeps, int count, int point,
                                     enum neph_sweep_cost cost, enum neph_sweep_number number);

/* {"format": "neph-stability-1", "sweeps", "cost", "moved", "points": [{"series", "label",
 * "number", "outcome", "on_fronts", "off"}, ...]}, for points on a front; for json_decref(). */
json_t *neph_stability_json(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost);

/* Prints the points that are on some fronts only, and the number of points by outcome. */
void neph_stability_print(const json_t *stability, FILE *out);

#endif

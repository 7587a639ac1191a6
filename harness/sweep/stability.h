/* SPDX-License-Identifier: MIT
 *
 * Whether a front is one of the engines or one of chance: sweeps of the same plan with other seeds,
 * in stores of their own, side by side.
 */
#ifndef NEPH_HARNESS_SWEEP_STABILITY_H
#define NEPH_HARNESS_SWEEP_STABILITY_H

#include "harness/sweep/equal.h"

/* What becomes of a point over the sweeps. */
enum neph_stability_outcome {
    NEPH_STABILITY_ABSENT, /* one of them has not measured it */
    NEPH_STABILITY_OFF,    /* on no front */
    NEPH_STABILITY_ON,     /* on all */
    NEPH_STABILITY_WITHIN, /* on some; where it is off nothing beats it beyond the intervals of
                              both, in cost and in number */
    NEPH_STABILITY_MOVED,  /* on some, and somewhere it is beaten beyond them */
    NEPH_STABILITY_OUTCOMES,
};
extern const char *const neph_stability_words[NEPH_STABILITY_OUTCOMES];

/* Whether `a` beats `b` whatever lies within their intervals: it is at most as dear and as large,
 * and less in one. What has no interval counts as it is. */
bool neph_stability_beats(const struct neph_sweep_point *a, const struct neph_sweep_point *b,
                          enum neph_sweep_cost cost, enum neph_sweep_number number);

/* What becomes of a point, by its index, in `count` sweeps of one plan. */
enum neph_stability_outcome neph_stability_judge(const struct neph_sweep *sweeps, int count,
                                                 int point, enum neph_sweep_cost cost,
                                                 enum neph_sweep_number number);

/* How far a point is off the fronts of these sweeps at most: by what part it would have to be
 * cheaper or better, whichever is less, so that nothing beats it. 0: it is on all. */
double neph_stability_off(const struct neph_sweep *sweeps, int count, int point,
                          enum neph_sweep_cost cost, enum neph_sweep_number number);

/* {"format": "neph-stability-1", "sweeps", "cost", "moved", "points": [{"series", "label",
 * "number", "outcome", "on_fronts", "off"}, ...]}, of points on a front; for the caller. */
json_t *neph_stability_json(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost);

/* That for people: points that are on some fronts, and how many there are of each outcome. */
void neph_stability_print(const json_t *stability, FILE *out);

#endif

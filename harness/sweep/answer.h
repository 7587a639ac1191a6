/* SPDX-License-Identifier: MIT
 *
 * What a sweep answers: which series is the cheapest at an error, and from how many steps on.
 */
#ifndef NEPH_HARNESS_SWEEP_ANSWER_H
#define NEPH_HARNESS_SWEEP_ANSWER_H

#include "harness/document/answer.h"
#include "harness/json.h"
#include "harness/sweep/equal.h"

/* The cheapest point with an error against the truth of no more than `error`, not of the series
 * `except` (NULL: of any); NULL: there is none. */
const struct neph_sweep_point *neph_sweep_cheapest(const struct neph_sweep *sweep, double error,
                                                   enum neph_sweep_cost cost,
                                                   const struct neph_sweep_series *except);

/* Time where frames were timed, else evaluations of density. */
enum neph_sweep_cost neph_sweep_cost_measured(const struct neph_sweep *sweep);

/* "`march`: 8 steps for 1 % of error ...", and what it is based on. */
void neph_sweep_answer(const struct neph_sweep *sweep, double error, struct neph_answer *answer);

/* The answer of several sweeps with other seeds (stability.h): whether the fronts are the same. */
void neph_stability_answer(const json_t *stability, struct neph_answer *answer);

#endif

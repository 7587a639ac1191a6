/* SPDX-License-Identifier: MIT
 *
 * The summary lines of a sweep: the cheapest series within an error, and the number of steps it
 * needs.
 */
#ifndef NEPH_HARNESS_SWEEP_ANSWER_H
#define NEPH_HARNESS_SWEEP_ANSWER_H

#include "harness/document/answer.h"
#include "harness/json.h"
#include "harness/sweep/equal.h"

/* The cheapest point with at most `error` against the ground truth, among all series but `except`
 * (NULL: all series); NULL: none. */
const struct neph_sweep_point *neph_sweep_cheapest(const struct neph_sweep *sweep, double error,
                                                   enum neph_sweep_cost cost,
                                                   const struct neph_sweep_series *except);

/* Time where frames were timed, else density evaluations. */
enum neph_sweep_cost neph_sweep_cost_measured(const struct neph_sweep *sweep);

/* Adds "`march`: 8 steps for 1 % of error ...", and lines with the basis of that statement. */
void neph_sweep_answer(const struct neph_sweep *sweep, double error, struct neph_answer *answer);

/* Adds whether the fronts of several sweeps with different seeds are equal (stability.h). */
void neph_stability_answer(const json_t *stability, struct neph_answer *answer);

#endif

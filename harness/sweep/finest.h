/* SPDX-License-Identifier: MIT
 *
 * Convergence of a ray marcher's steps: the error of each frame of a series against the series'
 * frame with the most steps. The error against the ground truth includes the bias of the lighting
 * model, which no number of steps removes; this error does not.
 */
#ifndef NEPH_HARNESS_SWEEP_FINEST_H
#define NEPH_HARNESS_SWEEP_FINEST_H

#include "harness/run/store.h"
#include "harness/sweep/results.h"
#include "harness/sweep/truth.h"

/* Computes to_finest of all points whose series varies `steps` and has no history. Frames come from
 * the store, all with the first seed; the mask is the ground truth's. Errors of reading a frame. */
enum neph_status neph_sweep_measure_finest(struct neph_sweep *sweep,
                                           const struct neph_sweep_truth *truth,
                                           struct neph_store *store, struct neph_diag *diag);

/* The point of a series with the most steps that has a frame; NULL: the series does not vary
 * `steps`, or has fewer than two such points. */
const struct neph_sweep_point *neph_sweep_finest(const struct neph_sweep *sweep,
                                                 const struct neph_sweep_series *series);

/* The point of a series with the fewest steps such that it and all finer points have a to_finest of
 * at most `error`; NULL: only the finest point itself. */
const struct neph_sweep_point *neph_sweep_converged(const struct neph_sweep *sweep,
                                                    const struct neph_sweep_series *series,
                                                    double error);

#endif

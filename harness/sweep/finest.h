/* SPDX-License-Identifier: MIT
 *
 * How far the steps of a ray marcher are from their limit: each frame of a series against the frame
 * of the series with the most steps. The error against the truth holds the bias of the lighting
 * model, too, which no number of steps removes; this number does not.
 */
#ifndef NEPH_HARNESS_SWEEP_FINEST_H
#define NEPH_HARNESS_SWEEP_FINEST_H

#include "harness/run/store.h"
#include "harness/sweep/results.h"
#include "harness/sweep/truth.h"

/* Fill to_finest of all points whose series varies `steps` and has no history. Frames come from the
 * store, all with the first seed; errors are taken over the mask of `truth`. Errors: of reading a
 * frame. */
enum neph_status neph_sweep_measure_finest(struct neph_sweep *sweep,
                                           const struct neph_sweep_truth *truth,
                                           struct neph_store *store, struct neph_diag *diag);

/* The point of a series with the most steps among those with a frame; NULL: the series does not
 * vary `steps`, or has fewer than two such points. */
const struct neph_sweep_point *neph_sweep_finest(const struct neph_sweep *sweep,
                                                 const struct neph_sweep_series *series);

/* The point of a series with the fewest steps from which on to_finest is no more than `error`;
 * NULL: none but the finest is. */
const struct neph_sweep_point *neph_sweep_converged(const struct neph_sweep *sweep,
                                                    const struct neph_sweep_series *series,
                                                    double error);

#endif

/* SPDX-License-Identifier: MIT
 *
 * What the points of a sweep are off from: `exact` where it has the scene, else the mean of two
 * pictures of the tracer, whose difference says how far it can be trusted.
 */
#ifndef NEPH_HARNESS_SWEEP_TRUTH_H
#define NEPH_HARNESS_SWEEP_TRUTH_H

#include "harness/run/store.h"
#include "harness/sweep/results.h"

struct neph_sweep_truth {
    const struct neph_engine *engine;
    struct neph_image *image; /* owned */
    double noise;             /* standard error over mean radiance, of all pixels; 0: none */
    double cpu_s, wall_s;     /* of its pictures, when they were rendered */
    const char *mask;         /* where errors are taken: "non_edge", as it looks through the
                                 centres of pixels where shortcuts average their squares; "all" in
                                 scenes without edges */
};

/* Find in the store or render. `shot` has scene, size and seed. NEPH_ERR_UNSUPPORTED: no engine
 * above the models can render the scene; NEPH_ERR_ENGINE; NEPH_ERR_INTERRUPTED. Free with
 * _finish. */
enum neph_status neph_sweep_truth_make(const struct neph_sweep_plan *plan,
                                       const struct neph_shot *shot, struct neph_store *store,
                                       struct neph_sweep_truth *truth, struct neph_diag *diag);
void neph_sweep_truth_finish(struct neph_sweep_truth *truth);

/* rel_rmse of a frame's radiance against it, with its interval over tiles of the picture; NaN where
 * the truth was not made. */
enum neph_status neph_sweep_truth_error(const struct neph_sweep_truth *truth,
                                        const char *frame_path, struct neph_sweep_value *error,
                                        struct neph_diag *diag);

#endif

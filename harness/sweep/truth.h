/* SPDX-License-Identifier: MIT
 *
 * The ground truth of a sweep: `exact` where it can render the scene, else the mean of two frames
 * of the tracer, whose difference gives the noise.
 */
#ifndef NEPH_HARNESS_SWEEP_TRUTH_H
#define NEPH_HARNESS_SWEEP_TRUTH_H

#include "harness/run/store.h"
#include "harness/sweep/results.h"

struct neph_sweep_truth {
    const struct neph_engine *engine;
    struct neph_image *image; /* owned */
    double noise;             /* standard error over mean radiance, over all pixels; 0: none */
    double cpu_s, wall_s;     /* of its frames, at the time of their rendering */
    const char *mask;         /* mask of errors: "non_edge", as the ground truth looks through pixel
                                 centres where real-time methods average over pixels; "all" in
                                 scenes without edges */
};

/* Finds the ground truth in the store, or renders it. `shot` has scene, size and seed.
 * NEPH_ERR_UNSUPPORTED: neither `exact` nor `tracer` can render the scene; NEPH_ERR_ENGINE;
 * NEPH_ERR_INTERRUPTED. Free with neph_sweep_truth_finish(). */
enum neph_status neph_sweep_truth_make(const struct neph_sweep_plan *plan,
                                       const struct neph_shot *shot, struct neph_store *store,
                                       struct neph_sweep_truth *truth, struct neph_diag *diag);
void neph_sweep_truth_finish(struct neph_sweep_truth *truth);

/* Relative RMSE of a frame's radiance against the ground truth, with its interval over tiles of the
 * frame; NaN when `truth` has no image. */
enum neph_status neph_sweep_truth_error(const struct neph_sweep_truth *truth,
                                        const char *frame_path, struct neph_sweep_value *error,
                                        struct neph_diag *diag);

#endif

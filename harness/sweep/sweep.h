/* SPDX-License-Identifier: MIT
 *
 * A sweep: cost and error of engines and settings for one scene.
 *
 * Frames and sequences go through the store. Times are measured while nothing else runs: frames in
 * flight, in rounds over all points, so that other load on the machine affects all points alike.
 * For engines without frames in flight they are the times of single frames.
 */
#ifndef NEPH_HARNESS_SWEEP_SWEEP_H
#define NEPH_HARNESS_SWEEP_SWEEP_H

#include "harness/run/store.h"
#include "harness/run/times.h"
#include "harness/sweep/results.h"

struct neph_sweep_params {
    const struct neph_sweep_plan *plan;
    const char *scene;       /* a name of the catalogue, or a path */
    const char *const *only; /* names of series, NULL-terminated; NULL: all */
    const char *against;     /* base series of comparisons; NULL: the first that has two points */
    double time_limit_s;     /* per child process */
    int seed, jobs; /* jobs: processes that render sequences and frames in flight; 0: one */
    struct neph_shared_device *device; /* like neph_shot.device */
    bool quiet;
    bool with_floors;         /* measure the floors of presets in a scene that moves, too */
    bool untimed;             /* measure no times; density evaluations are the cost */
    struct neph_times *times; /* stored times, which are not measured again; NULL when untimed */
    bool remeasures_times;    /* measure them again */
    const bool *wanted; /* selected points, [series * NEPH_SWEEP_VALUES_MAX + place]; NULL: all */
};

/* Runs the sweep. A point that an engine cannot render has the reason in `missing`.
 * NEPH_ERR_INTERRUPTED: finished frames stay in the store. NEPH_ERR_UNSUPPORTED: no ground truth
 * for this scene. Call neph_sweep_finish() in any case. */
enum neph_status neph_sweep_run(const struct neph_sweep_params *params, struct neph_store *store,
                                struct neph_sweep *sweep, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A sweep: engines and their settings over one scene, each point with what it costs and what it is
 * off by.
 *
 * Frames and sequences go through the store. Times do not: they are measured with nothing else
 * going on, pictures in flight, in rounds that take turns over all points, so that what the machine
 * does in between hits all alike; or, of engines without flight, are those of whole pictures.
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
    const char *against; /* a series that others are held against; NULL: the first that can be */
    double time_limit_s; /* per child process */
    int seed, jobs;      /* jobs: processes that render sequences and pictures in flight; 0: one */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
    bool untimed;             /* no times: evaluations are the cost */
    struct neph_times *times; /* what was timed before is not timed again; NULL when untimed */
    bool retimes;             /* but with this it is */
    const bool *wanted; /* points, by series of the plan and place: [series * NEPH_SWEEP_VALUES_MAX
                           + place]; NULL: all */
};

/* Run it. Engines that cannot render a point say so in it. NEPH_ERR_INTERRUPTED: what is finished
 * stays in the store. NEPH_ERR_UNSUPPORTED: there is no truth of this scene. For
 * neph_sweep_finish() in any case. */
enum neph_status neph_sweep_run(const struct neph_sweep_params *params, struct neph_store *store,
                                struct neph_sweep *sweep, struct neph_diag *diag);

#endif

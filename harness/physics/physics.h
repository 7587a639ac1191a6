/* SPDX-License-Identifier: MIT
 *
 * The physics suite: every engine compared with references that need no renderer. Each check of
 * each participant yields a relative deviation with a standard error (stochastic engines: per-pixel
 * variance or two seeds) or a step bound (deterministic engines: two step sizes), a z-score, and a
 * verdict at a level corrected for the number of checks (Sidak).
 */
#ifndef NEPH_HARNESS_PHYSICS_PHYSICS_H
#define NEPH_HARNESS_PHYSICS_PHYSICS_H

#include "harness/physics/results.h"
#include "harness/run/store.h"

struct neph_physics_params {
    const char *const *engines; /* names of engines; engine_count 0: all */
    int engine_count;
    const char *const *only; /* texts, one of which must be part of a check's name or rung */
    int only_count;          /* 0: all checks */
    int jobs;                /* processes that render at the same time, 1 .. */
    int samples;             /* paths per pixel and seed of the built-in path tracers */
    double time_limit_s;     /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

/* Run the suite. `physics` must be {0} before; always free it with neph_physics_finish(). Returns
 * NEPH_OK also when engines deviate: only deviations of the built-in reference engines clear
 * `passes`. */
enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, struct neph_physics *physics,
                                  struct neph_diag *diag);

#endif

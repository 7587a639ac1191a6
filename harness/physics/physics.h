/* SPDX-License-Identifier: MIT
 *
 * The physics suite: every engine held against truth that needs no renderer. Each check of each
 * participant gives a relative deviation with a standard error (stochastic engines: per-pixel
 * variance or two seeds) or a step bound (deterministic ones: two step sizes), a z-score, and a
 * verdict at a level corrected for the number of checks (Sidak).
 */
#ifndef NEPH_HARNESS_PHYSICS_PHYSICS_H
#define NEPH_HARNESS_PHYSICS_PHYSICS_H

#include "harness/physics/results.h"
#include "harness/run/store.h"

struct neph_physics_params {
    const char *const *engines; /* names of engines; engine_count 0: all */
    int engine_count;
    const char *const *only; /* checks with one of these texts in their name or rung, .. */
    int only_count;          /* .. 0: all */
    int jobs;                /* processes that render at the same time, 1 .. */
    int samples;             /* paths per pixel of our tracers, per seed */
    double time_limit_s;     /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
    bool quiet;
};

/* Run. `physics`, {0} before, is for neph_physics_finish() in any case. NEPH_OK also when engines
 * are off: only our own truth engines keep it from passing. */
enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, struct neph_physics *physics,
                                  struct neph_diag *diag);

#endif

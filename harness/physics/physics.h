/* SPDX-License-Identifier: MIT
 *
 * The physics suite: every engine held against truth that needs no renderer. Each check of each
 * participant gives a relative deviation with a standard error (stochastic engines: per-pixel
 * variance or two seeds) or a step bound (deterministic ones: two step sizes), a z-score, and a
 * verdict at a level corrected for the number of checks (Sidak).
 */
#ifndef NEPH_HARNESS_PHYSICS_PHYSICS_H
#define NEPH_HARNESS_PHYSICS_PHYSICS_H

#include "harness/json.h"
#include "harness/run/store.h"

struct neph_physics_params {
    const char *const *engines; /* names; engine_count 0: all */
    int engine_count;
    const char *only;    /* checks whose name or rung contains this; NULL: all */
    int samples;         /* paths per pixel of our tracers, per seed */
    double time_limit_s; /* per child process */
    bool quiet;
};

/* The probability that a run in which every engine is right still calls one of them off. */
#define NEPH_PHYSICS_FAMILY_ALPHA 0.01

/* Run. `*document` (the caller's) has the form of the report's "physics"
 * (scripts/report/README.md). NEPH_OK also when engines are off: "verdict" is "fail" only when our
 * own truth engines are. */
enum neph_status neph_physics_run(const struct neph_physics_params *params,
                                  struct neph_store *store, json_t **document,
                                  struct neph_diag *diag);

/* The document's table and sentences for a terminal, on stdout. */
void neph_physics_print(const json_t *document);

#endif

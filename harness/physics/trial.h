/* SPDX-License-Identifier: MIT
 *
 * One participant in one check: its frames rendered, held against the truth pixel by pixel, and
 * what that says of its deviation.
 */
#ifndef NEPH_HARNESS_PHYSICS_TRIAL_H
#define NEPH_HARNESS_PHYSICS_TRIAL_H

#include "harness/physics/results.h"
#include "harness/physics/scenery.h"
#include "harness/run/store.h"

/* A participant that is ready. */
struct neph_entrant {
    const struct neph_participant *participant;
    const struct neph_engine *engine;
    struct neph_engine_info info;
    struct neph_settings settings, refined;
};

/* Borrowed. */
struct neph_trial {
    const struct neph_entrant *entrant;
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
    struct neph_store *store;
    struct neph_arena *arena; /* of the results */
};

/* Fill `row` ({0} before, but for its check) up to its cause. NEPH_OK whatever the engine did. The
 * scenery may be changed meanwhile, and is as it was afterwards. */
enum neph_status neph_trial_run(const struct neph_trial *trial, struct neph_scenery *scenery,
                                struct neph_physics_row *row, struct neph_diag *diag);

#endif

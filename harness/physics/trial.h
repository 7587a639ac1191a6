/* SPDX-License-Identifier: MIT
 *
 * One participant in one check: renders its frames, compares them with the reference pixel by
 * pixel, and computes its deviation.
 */
#ifndef NEPH_HARNESS_PHYSICS_TRIAL_H
#define NEPH_HARNESS_PHYSICS_TRIAL_H

#include "harness/physics/results.h"
#include "harness/run/store.h"

/* ---- scenery --------------------------------------------------------------------------------- */

/* A check with its scenes built and the reference of every pixel computed. */
enum { NEPH_SCENERY_PIXELS_MAX = 1024 };

struct neph_scenery_view {
    const struct neph_check_view *view;
    struct neph_stage *stage;
    int pixel_count;
    double truth[NEPH_SCENERY_PIXELS_MAX], weight[NEPH_SCENERY_PIXELS_MAX];
    double truth_error; /* relative error of the mean reference; 0: exact */
};

/* Large, and its views point into its check: must not be copied. */
struct neph_scenery {
    struct neph_check check;
    struct neph_scenery_view views[NEPH_CHECK_VIEWS_MAX];
};

/* Build the check of this index. After success free it with neph_scenery_leave(). */
enum neph_status neph_scenery_enter(int index, struct neph_scenery *scenery,
                                    struct neph_diag *diag);
void neph_scenery_leave(struct neph_scenery *scenery);

/* ---- trials ---------------------------------------------------------------------------------- */

/* A participant with its engine probed and its settings applied. */
struct neph_entrant {
    const struct neph_participant *participant;
    const struct neph_engine *engine;
    struct neph_engine_info info;
    struct neph_settings settings, refined;
};

/* All pointers are borrowed. */
struct neph_trial {
    const struct neph_entrant *entrant;
    double time_limit_s;               /* per child process */
    struct neph_shared_device *device; /* as neph_shot.device */
    struct neph_store *store;
    struct neph_arena *arena; /* for the results */
};

/* Fill `row` ({0} before, except for its check) up to `cause`. Returns NEPH_OK for failures of the
 * engine as well. The scenery is modified temporarily and restored. */
enum neph_status neph_trial_run(const struct neph_trial *trial, struct neph_scenery *scenery,
                                struct neph_physics_row *row, struct neph_diag *diag);

#endif

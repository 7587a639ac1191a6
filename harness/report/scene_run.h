/* SPDX-License-Identifier: MIT
 *
 * One scene of the main job: a picture by each engine, a second seed where chance plays a part, all
 * measured against the highest rung of truth, and the gates.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_RUN_H
#define NEPH_HARNESS_REPORT_SCENE_RUN_H

#include "harness/progress.h"
#include "harness/report/validation.h"

/* What all scenes of a run have in common; borrowed. */
struct neph_scene_run {
    const struct neph_field *field;
    int width_px, height_px;
    int frame;       /* of every scene; the last frame of a shorter one */
    int seed;        /* the how-manieth of engines that draw paths, from 1 */
    double budget_s; /* of each picture of another project's renderer: see budget.h */
    struct neph_shared_device *device; /* as neph_shot.device */
    struct neph_store *store;
    struct neph_progress *progress; /* its kinds 0 .. NEPH_SCENE_RUN_KINDS - 1 are ours */
    struct neph_arena *arena;       /* of the results */
};

enum { NEPH_SCENE_RUN_KINDS = 2 * NEPH_FIELD_MAX };

/* There will be `count` more scenes; negative: fewer. */
void neph_scene_run_expect(const struct neph_scene_run *run, int count);

/* Run one. `*result`, {0} before, is for neph_scene_result_finish() in any case. */
enum neph_status neph_scene_run(const struct neph_scene_run *run, const struct neph_scene *scene,
                                struct neph_scene_result *result, struct neph_diag *diag);

#endif

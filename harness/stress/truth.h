/* SPDX-License-Identifier: MIT
 *
 * References of the stress tests. Presets are compared with the reference that their scenario
 * names, engines that render each frame independently with `exact`.
 */
#ifndef NEPH_HARNESS_STRESS_TRUTH_H
#define NEPH_HARNESS_STRESS_TRUTH_H

#include "harness/study/reference.h"

/* Whether all frames of a stress scene are equal: nothing moves and no light changes. */
bool neph_stress_is_static(const struct neph_scene *scene);

/* Frames of a test: first, first + step, ... */
struct neph_stress_frames {
    int count, step;
};

/* Frames for engines: one of a static scene, otherwise the first, the middle and the last. */
struct neph_stress_frames neph_stress_engine_frames(const struct neph_scene *scene);

/* The reference of presets; `test` is a job of one of them. Free with neph_reference_finish().
 * Errors as of neph_reference_make() and neph_outcome_check(); NEPH_ERR_INPUT: `truth: exact` for a
 * moving scene. */
enum neph_status neph_stress_preset_truth(const struct neph_job *test, struct neph_store *store,
                                          struct neph_progress *progress,
                                          struct neph_reference *reference, struct neph_diag *diag);

/* Frames of `exact` for the frames of a test. NEPH_ERR_ENGINE: `exact` cannot render the scene. */
enum neph_status neph_stress_engine_truth(const struct neph_job *test,
                                          const struct neph_stress_frames *frames,
                                          struct neph_store *store,
                                          struct neph_reference *reference, struct neph_diag *diag);

#endif

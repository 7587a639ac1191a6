/* SPDX-License-Identifier: MIT
 *
 * The step studies that are installed with neph (scenes/studies/ENGINE.json). They take minutes,
 * and their result changes only with the scene, the engine and its driver in neph. `neph study
 * --renew` measures them again.
 */
#ifndef NEPH_HARNESS_STUDY_STUDIES_H
#define NEPH_HARNESS_STUDY_STUDIES_H

#include "harness/study/study.h"

/* Frame size of step studies: the mean over the frame needs no more. */
enum { NEPH_STUDIES_WIDTH_PX = 32, NEPH_STUDIES_HEIGHT_PX = 18 };

/* Finds the installed study of the job's scene and engine. `*found`: one exists for this scene,
 * engine, version and driver. NEPH_ERR_INPUT: the file was not written by neph. */
enum neph_status neph_studies_find(const struct neph_job *job, struct neph_study *study,
                                   bool *found, struct neph_diag *diag);

/* Measures a study at NEPH_STUDIES_WIDTH_PX, without installing it. `*outcome` and `reason` as of
 * neph_study_run(). */
enum neph_status neph_studies_make(const struct neph_job *job, struct neph_store *store,
                                   struct neph_study *study, enum neph_outcome *outcome,
                                   char reason[1600], struct neph_diag *diag);

/* Measures the scenes (names of the catalogue, or paths) with every external renderer that has
 * steps, and installs the studies. Skips studies that exist for the same scene, engine, version and
 * driver, scenes without their data, and scenes that an engine cannot render. After
 * NEPH_ERR_INTERRUPTED the finished studies are kept. `keeps` false: results stay in the store
 * only, for processes that run at the same time. */
enum neph_status neph_studies_renew(const char *const *scenes, int scene_count, double time_limit_s,
                                    struct neph_store *store, bool keeps, bool quiet,
                                    struct neph_diag *diag);

#endif

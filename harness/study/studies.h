/* SPDX-License-Identifier: MIT
 *
 * Step studies that come with neph (scenes/studies/ENGINE.json): they take minutes, and their
 * result changes only with the scene, the engine and our driver of it. `neph study --renew` makes
 * them anew.
 */
#ifndef NEPH_HARNESS_STUDY_STUDIES_H
#define NEPH_HARNESS_STUDY_STUDIES_H

#include "harness/study/study.h"

/* The size in pixels at which studies choose a step: a mean over the picture needs no more. */
enum { NEPH_STUDIES_WIDTH_PX = 32, NEPH_STUDIES_HEIGHT_PX = 18 };

/* The study of the job's scene by its engine; `*found` tells whether one is there for just this
 * scene, engine, version and driver. NEPH_ERR_INPUT: the file is not what neph wrote. */
enum neph_status neph_studies_find(const struct neph_job *job, struct neph_study *study,
                                   bool *found, struct neph_diag *diag);

/* Make one at the size of studies; it does not become one that comes with neph. Outcome and reason
 * as of neph_study_run(). */
enum neph_status neph_studies_make(const struct neph_job *job, struct neph_store *store,
                                   struct neph_study *study, enum neph_outcome *outcome,
                                   char reason[1600], struct neph_diag *diag);

/* Study the scenes (names of the catalogue, or paths) with every witness that marches in steps, and
 * keep what comes of it. What is there for just this scene, engine, version and driver is left
 * alone. A scene whose data is not here, or that an engine cannot render, is passed over. With
 * NEPH_ERR_INTERRUPTED what is finished is kept. Not `keeps`: only the store has what comes of it,
 * so that processes may do that at the same time. */
enum neph_status neph_studies_renew(const char *const *scenes, int scene_count, double time_limit_s,
                                    struct neph_store *store, bool keeps, bool quiet,
                                    struct neph_diag *diag);

#endif

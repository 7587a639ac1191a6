/* SPDX-License-Identifier: MIT
 *
 * Step studies that come with neph (scenes/studies/ENGINE.json): they take minutes, and their
 * result changes only with the scene, the engine and our driver of it. `neph study --renew` makes
 * them anew.
 */
#ifndef NEPH_HARNESS_STUDY_STUDIES_H
#define NEPH_HARNESS_STUDY_STUDIES_H

#include "harness/json.h"
#include "harness/run/job.h"

/* The size in pixels at which studies choose a step: a mean over the picture needs no more. */
enum { NEPH_STUDIES_WIDTH_PX = 32, NEPH_STUDIES_HEIGHT_PX = 18 };

/* The job whose levels a study of `job` runs: small, radiance alone. */
struct neph_job neph_studies_job(const struct neph_job *job);

/* The study of the job's scene by its engine, as neph_study_json() with "size_px" and "shipped",
 * for the caller; `*study` is NULL when none is there for just this scene, engine, version and
 * driver. NEPH_ERR_INPUT: the file is not what neph wrote. */
enum neph_status neph_studies_find(const struct neph_job *job, json_t **study,
                                   struct neph_diag *diag);

/* Put a study (which stays the caller's) in the place of the one of the same scene. */
enum neph_status neph_studies_keep(const struct neph_job *job, const json_t *study,
                                   struct neph_diag *diag);

/* Study the scenes (names of the catalogue, or paths) with every witness that marches in steps, and
 * keep what comes of it. What is there for just this scene, engine, version and driver is left
 * alone. A scene whose data is not here, or that an engine cannot render, is passed over. With
 * NEPH_ERR_INTERRUPTED what is finished is kept. */
enum neph_status neph_studies_renew(const char *const *scenes, int scene_count, double time_limit_s,
                                    struct neph_store *store, bool quiet, struct neph_diag *diag);

/* Set the step option as the study, made or found, has chosen. NEPH_ERR_INPUT: it names a setting
 * that the engine does not take. */
enum neph_status neph_studies_apply(const json_t *study, const struct neph_engine *engine,
                                    struct neph_settings *settings, struct neph_diag *diag);

#endif

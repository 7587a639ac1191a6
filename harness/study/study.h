/* SPDX-License-Identifier: MIT
 *
 * Step study: for one scene, the bias of an engine with finite steps relative to its own limit of
 * infinitely small steps, and the coarsest setting that is accurate enough. More samples per pixel
 * do not remove the bias of a step (e^-x of a noisy optical depth is too bright on average).
 * Smaller steps do, with a known order, so the remaining bias can be extrapolated (L. F. Richardson
 * 1911).
 */
#ifndef NEPH_HARNESS_STUDY_STUDY_H
#define NEPH_HARNESS_STUDY_STUDY_H

#include "harness/run/job.h"

enum { NEPH_STUDY_LEVELS_MAX = 8 };

/* Allowed bias of a chosen setting, relative to the mean radiance. */
#define NEPH_STUDY_TOLERANCE 1e-3

/* Verdict on the chosen level's bias. */
enum neph_study_verdict {
    NEPH_STUDY_WITHIN, /* within the tolerance, noise included */
    NEPH_STUDY_NOISE,  /* below the noise, so not known to be within the tolerance */
    NEPH_STUDY_OFF,    /* the finest level may exceed the tolerance: its bias does, or its error
                          does not fall with the known order and the last change exceeds the
                          tolerance */
    NEPH_STUDY_VERDICT_COUNT,
};

struct neph_study_level {
    double setting;    /* of the engine's step option */
    double radiance;   /* mean over the frame and the channels [W m^-2 sr^-1] */
    double noise;      /* standard error of the radiance; 0 for deterministic engines */
    double bias;       /* relative, against the extrapolated limit */
    double bias_noise; /* standard error of the bias; noise common to the levels cancels */
    double wall_s;
};

struct neph_study {
    const char *option;    /* name of the step option; static */
    double order;          /* used for the extrapolation */
    double observed_order; /* from the last three levels; NaN where noise or rounding dominates */
    int level_count;
    struct neph_study_level levels[NEPH_STUDY_LEVELS_MAX]; /* from coarse to fine */
    double limit;                                          /* extrapolated radiance */
    int chosen; /* WITHIN: the coarsest level from which on |bias| + 2 noise is within the
                   tolerance; NOISE: from which on the bias is below the noise; OFF: the finest
                   level */
    enum neph_study_verdict verdict;
    double tolerance;        /* the tolerance used for the verdict */
    int width_px, height_px; /* of the study's frames where they are smaller than the job's; else 0
                                */
    bool is_shipped;         /* installed with neph: see studies.h */
};

/* Largest deviation of the observed order from the known one for a valid extrapolation. */
#define NEPH_STUDY_ORDER_SLACK 1.0

/* Whether a study makes sense: the engine has a step (engine.h), and the scene has a medium that is
 * not homogeneous. */
bool neph_study_applies(const struct neph_engine *engine, const struct neph_scene *scene);

/* The index-th job of a study, from 0: a level with a seed. False: there are no more. */
bool neph_study_job(const struct neph_job *job, int index, struct neph_job *made);

/* Runs all levels of the job's engine on its scene and size; frames go through the store. `study`
 * is valid only when `*outcome` is NEPH_OUTCOME_RENDERED. Otherwise `reason` says why: a frame
 * could not be rendered, or the frame is black, so a relative bias is undefined
 * (NEPH_OUTCOME_CANNOT). */
enum neph_status neph_study_run(const struct neph_job *job, struct neph_store *store,
                                struct neph_study *study, enum neph_outcome *outcome,
                                char reason[1600], struct neph_diag *diag);

/* The study as JSON for reports: {"option", "order", "observed_order", "limit", "levels": [...],
 * "chosen", "verdict" ("within", "noise" or "off"), "tolerance"}, and "size_px" and "shipped" where
 * they apply. */
json_t *neph_study_json(const struct neph_study *study);

/* Reads a study of this engine from JSON. NEPH_ERR_INPUT: not a study, or a setting outside the
 * engine's range. */
enum neph_status neph_study_read(json_t *json, const struct neph_engine *engine,
                                 struct neph_study *study, struct neph_diag *diag);

const char *neph_study_verdict_name(enum neph_study_verdict verdict);

/* Sets the step option in `settings` to the chosen level. */
void neph_study_apply(const struct neph_study *study, const struct neph_engine *engine,
                      struct neph_settings *settings);

#endif

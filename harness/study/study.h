/* SPDX-License-Identifier: MIT
 *
 * The step-halving study: how far an engine that marches in steps is from its own limit of
 * infinitely small steps, for one scene, and which setting is good enough. More samples per pixel
 * never remove a step's bias (e^-x of a noisy optical depth is too bright on average); smaller
 * steps do, by a known order, and so the rest can be extrapolated (L. F. Richardson 1911).
 */
#ifndef NEPH_HARNESS_STUDY_STUDY_H
#define NEPH_HARNESS_STUDY_STUDY_H

#include "harness/run/job.h"

enum { NEPH_STUDY_LEVELS_MAX = 8 };

/* The bias, relative to the mean radiance, that a chosen setting may have. */
#define NEPH_STUDY_TOLERANCE 1e-3

/* What is known of the chosen level's bias. */
enum neph_study_verdict {
    NEPH_STUDY_WITHIN, /* within the tolerance for certain, noise included */
    NEPH_STUDY_NOISE,  /* noise hides whether it is */
    NEPH_STUDY_OFF,    /* even the finest step is off by more, or may be: its error does not shrink
                          by the known order, and the last change was larger than the tolerance */
    NEPH_STUDY_VERDICT_COUNT,
};

struct neph_study_level {
    double setting;    /* of the engine's step option */
    double radiance;   /* mean over the picture [W m^-2 sr^-1], channels averaged */
    double noise;      /* standard error of it; 0 for deterministic engines */
    double bias;       /* relative, against the extrapolated limit */
    double bias_noise; /* standard error of the bias: the noise that levels share cancels */
    double wall_s;
};

struct neph_study {
    const char *option;    /* name of the step option; static */
    double order;          /* used for the extrapolation */
    double observed_order; /* from the last three levels; NaN where noise or roundness hides it */
    int level_count;
    struct neph_study_level levels[NEPH_STUDY_LEVELS_MAX]; /* coarse to fine */
    double limit;                                          /* extrapolated radiance */
    int chosen; /* the coarsest level from which on |bias| + 2 noise is within the tolerance; where
                   noise hides that of all, from which on the bias cannot be told from 0; the finest
                   where that is off */
    enum neph_study_verdict verdict;
    double tolerance;        /* that the verdict stands on */
    int width_px, height_px; /* of its pictures, where those are smaller than the job's; else 0 */
    bool is_shipped;         /* it came with neph: see studies.h */
};

/* How far the observed order may be from the known one for the extrapolation to hold. */
#define NEPH_STUDY_ORDER_SLACK 1.0

/* Whether there is anything to study: the engine has a step (engine.h) and the scene a medium that
 * is not homogeneous. */
bool neph_study_applies(const struct neph_engine *engine, const struct neph_scene *scene);

/* The index-th job of such a study, from 0 on: a level with a seed. False: there are no more. */
bool neph_study_job(const struct neph_job *job, int index, struct neph_job *made);

/* Run the levels of `job`'s engine on its scene at its size (frames go through the store).
 * `*outcome` and `reason` say what became of it when a frame could not be had or is black, so that
 * there is nothing to be off from (NEPH_OUTCOME_CANNOT); `study` is valid only with
 * NEPH_OUTCOME_RENDERED. */
enum neph_status neph_study_run(const struct neph_job *job, struct neph_store *store,
                                struct neph_study *study, enum neph_outcome *outcome,
                                char reason[1600], struct neph_diag *diag);

/* The study for reports: {"option", "order", "observed_order", "limit", "levels": [...], "chosen",
 * "verdict" ("within", "noise" or "off"), "tolerance"}, and where there is such a thing "size_px"
 * and "shipped". */
json_t *neph_study_json(const struct neph_study *study);

/* The other way, of a study by this engine. NEPH_ERR_INPUT: it is none, or its setting is not one
 * that the engine takes. */
enum neph_status neph_study_read(json_t *json, const struct neph_engine *engine,
                                 struct neph_study *study, struct neph_diag *diag);

const char *neph_study_verdict_name(enum neph_study_verdict verdict);

/* Set the step option of `settings` to the chosen level's. */
void neph_study_apply(const struct neph_study *study, const struct neph_engine *engine,
                      struct neph_settings *settings);

#endif

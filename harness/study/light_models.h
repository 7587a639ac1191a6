/* SPDX-License-Identifier: MIT
 *
 * Lighting models by name, for what holds them against the tracer: an engine of the model rung with
 * its settings.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_MODELS_H
#define NEPH_HARNESS_STUDY_LIGHT_MODELS_H

#include "harness/run/job.h"

enum { NEPH_LIGHT_MODELS_MAX = 8 };

/* Pictures that an engine which remembers has had before the one that is measured, unless a model
 * says otherwise: with that one, 32 from a cold start. */
enum { NEPH_LIGHT_WARM_UP = 31 };

struct neph_light_model {
    const struct neph_engine *engine;
    struct neph_settings settings;
    struct neph_engine_info info;
};

/* "NAME", or "NAME+KEY=VALUE+...", where preset=WORD is one, too; with so many steps of every view
 * ray unless it says otherwise; `device`: as of neph_engine_probe(). NEPH_ERR_USAGE: no engine of
 * the model rung, or none of its settings. */
enum neph_status neph_light_model_parse(const char *words, int steps,
                                        struct neph_shared_device *device,
                                        struct neph_light_model *model, struct neph_diag *diag);

/* An engine, as it is by default. */
struct neph_light_model neph_light_model_of(const struct neph_engine *engine,
                                            struct neph_shared_device *device);

/* Errors as of neph_settings_set(). */
enum neph_status neph_light_model_set(struct neph_light_model *model, const char *key, double value,
                                      struct neph_diag *diag);

/* A model's job of a shot that has all but settings and a time limit; there is no limit. */
struct neph_job neph_light_model_job(const struct neph_light_model *model,
                                     const struct neph_shot *shot);

/* Its frame, from the store or rendered; the time that its rendering took is added to `*seconds`.
 * Errors as of neph_job_run() and neph_outcome_check(). */
enum neph_status neph_light_model_render(const struct neph_light_model *model,
                                         const struct neph_shot *shot, struct neph_store *store,
                                         struct neph_image **frame, double *seconds,
                                         struct neph_diag *diag);

/* Whether it claims no physics (harness/engines/look.h). */
bool neph_light_model_is_look(const struct neph_light_model *model);

/* All that engines offer, as "A,B", NEPH_LIGHT_MODELS_MAX at most: every engine of the model rung
 * that is no shortcut of another; and every choice of an engine's option `lighting` beyond the
 * first that no engine march_CHOICE stands for. For the caller to free; NULL when memory is short.
 */
char *neph_light_models_offered(void);

#endif

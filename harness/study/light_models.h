/* SPDX-License-Identifier: MIT
 *
 * Lighting models by name, for comparisons with the tracer: a model engine with settings.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_MODELS_H
#define NEPH_HARNESS_STUDY_LIGHT_MODELS_H

#include "harness/run/job.h"

enum { NEPH_LIGHT_MODELS_MAX = 8 };

/* Frames that an engine with a history renders before the measured one, unless the model sets
 * another number. With the measured one: 32 frames from a cold start. */
enum { NEPH_LIGHT_WARM_UP = 31 };

struct neph_light_model {
    const struct neph_engine *engine;
    struct neph_settings settings;
    struct neph_engine_info info;
};

/* Parses "NAME" or "NAME+KEY=VALUE+...", where preset=WORD is allowed, too. `steps` is the number
 * of steps of a view ray unless the words set it. `device` as of neph_engine_probe().
 * NEPH_ERR_USAGE: not a model engine, or not one of its settings. */
enum neph_status neph_light_model_parse(const char *words, int steps,
                                        struct neph_shared_device *device,
                                        struct neph_light_model *model, struct neph_diag *diag);

/* An engine at its defaults. */
struct neph_light_model neph_light_model_default(const struct neph_engine *engine,
                                                 struct neph_shared_device *device);

/* Errors as of neph_settings_set(). */
enum neph_status neph_light_model_set(struct neph_light_model *model, const char *key, double value,
                                      struct neph_diag *diag);

/* The model's job of a shot. The job gets the model's settings and no time limit. */
struct neph_job neph_light_model_job(const struct neph_light_model *model,
                                     const struct neph_shot *shot);

/* The frame of a model, from the store or rendered; its render time is added to `*seconds`. Errors
 * as of neph_job_run() and neph_outcome_check(). */
enum neph_status neph_light_model_render(const struct neph_light_model *model,
                                         const struct neph_shot *shot, struct neph_store *store,
                                         struct neph_image **frame, double *seconds,
                                         struct neph_diag *diag);

/* Whether the model is non-physical (harness/engines/non_physical.h). */
bool neph_light_model_is_non_physical(const struct neph_light_model *model);

/* All models that engines offer, as "A,B", at most NEPH_LIGHT_MODELS_MAX:
 *
 * - every model engine, except real-time methods and engines for one kind of scene;
 * - every choice of an option `lighting` after the first, except those that an engine march_CHOICE
 *   provides.
 *
 * The caller frees the text; NULL: out of memory. */
char *neph_light_models_list(void);

#endif

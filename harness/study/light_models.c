/* SPDX-License-Identifier: MIT
 *
 * Lighting models: parsing, jobs, and the list of all that engines offer.
 */
#include "harness/study/light_models.h"

#include "base/exr.h"
#include "base/written.h"
#include "harness/engines/engines.h"
#include "harness/engines/non_physical.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- parsing --------------------------------------------------------------------------------- */

enum neph_status neph_light_model_set(struct neph_light_model *model, const char *key, double value,
                                      struct neph_diag *diag)
{
    char assignment[64];
    snprintf(assignment, sizeof(assignment), "%s=%.17g", key, value);
    return neph_settings_set(model->engine, &model->settings, assignment, diag);
}

struct neph_light_model neph_light_model_default(const struct neph_engine *engine,
                                                 struct neph_shared_device *device)
{
    struct neph_light_model model = {.engine = engine, .settings = neph_settings_default(engine)};
    neph_engine_probe(engine, device, &model.info);
    return model;
}

/* Sets the settings that all models share. A preset brings its own steps, which are replaced, too.
 */
static enum neph_status set_common(struct neph_light_model *model, int steps,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (neph_option_find(model->engine->options, "steps") >= 0)
        status = neph_light_model_set(model, "steps", steps, diag);
    if (!status && neph_option_find(model->engine->options, "warm_up") >= 0)
        status = neph_light_model_set(model, "warm_up", NEPH_LIGHT_WARM_UP, diag);
    return status;
}

static enum neph_status apply(struct neph_light_model *model, const char *word, int steps,
                              struct neph_diag *diag)
{
    static const char preset[] = "preset=";
    if (strncmp(word, preset, strlen(preset)) != 0)
        return neph_settings_set(model->engine, &model->settings, word, diag);
    const enum neph_status status = neph_settings_preset(model->engine, word + strlen(preset),
                                                         &model->settings, diag);
    return status ? status : set_common(model, steps, diag);
}

static enum neph_status find_engine(const char *name, struct neph_shared_device *device,
                                    struct neph_light_model *model, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(name);
    if (!engine || engine->rung != NEPH_LEVEL_MODEL) {
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' is no lighting model", name);
        neph_hint(diag, "march, march_octaves and the other engines called march_; "
                        "realtime+lighting=WORD");
        return NEPH_ERR_USAGE;
    }
    *model = neph_light_model_default(engine, device);
    return NEPH_OK;
}

/* Words are separated by '+'. */
enum neph_status neph_light_model_parse(const char *words, int steps,
                                        struct neph_shared_device *device,
                                        struct neph_light_model *model, struct neph_diag *diag)
{
    char *copy = strdup(words), *rest = copy;
    if (!copy)
        return neph_fail_memory(diag);
    struct neph_light_model made = {.engine = NULL};
    enum neph_status status = find_engine(strsep(&rest, "+"), device, &made, diag);
    if (!status)
        status = set_common(&made, steps, diag);
    while (rest && !status)
        status = apply(&made, strsep(&rest, "+"), steps, diag);
    free(copy);
    if (!status)
        *model = made;
    return status;
}

bool neph_light_model_is_non_physical(const struct neph_light_model *model)
{
    return neph_is_non_physical(model->engine, &model->settings);
}

/* ---- frames ---------------------------------------------------------------------------------- */

struct neph_job neph_light_model_job(const struct neph_light_model *model,
                                     const struct neph_shot *shot)
{
    struct neph_job job = {.engine = model->engine, .info = &model->info, .shot = *shot};
    job.shot.settings = model->settings;
    job.shot.time_limit_s = INFINITY;
    return job;
}

enum neph_status neph_light_model_render(const struct neph_light_model *model,
                                         const struct neph_shot *shot, struct neph_store *store,
                                         struct neph_image **frame, double *seconds,
                                         struct neph_diag *diag)
{
    const struct neph_job job = neph_light_model_job(model, shot);
    struct neph_job_result result = {.settings = NULL};
    enum neph_status status = neph_job_run(&job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_exr_read(result.frame_path, frame, diag);
    if (!status)
        *seconds += isnan(result.cost.render_s) ? result.cost.wall_s : result.cost.render_s;
    neph_job_result_finish(&result);
    return status;
}

/* ---- the list of models ---------------------------------------------------------------------- */

static void list_model(const char *engine, const char *lighting, int *count, FILE *out)
{
    if ((*count)++ < NEPH_LIGHT_MODELS_MAX)
        fprintf(out, "%s%s%s%s", *count > 1 ? "," : "", engine, lighting ? "+lighting=" : "",
                lighting ? lighting : "");
}

static void list_lightings(const struct neph_engine *engine, int *count, FILE *out)
{
    const int index = neph_option_find(engine->options, "lighting");
    if (engine->rung != NEPH_LEVEL_MODEL || index < 0)
        return;
    const char *const *choices = engine->options[index].choices;
    for (int i = 1; choices && choices[i - 1] && choices[i]; i++)
        if (!neph_engine_find_by_lighting(choices[i]))
            list_model(engine->name, choices[i], count, out);
}

static void list_models(const void *unused, FILE *out)
{
    int engine_count, count = 0;
    const struct neph_engine *const *engines = neph_engines(&engine_count);
    (void)unused;
    for (int e = 0; e < engine_count; e++)
        if (engines[e]->rung == NEPH_LEVEL_MODEL && !engines[e]->shortcut_of &&
            !engines[e]->is_narrow)
            list_model(engines[e]->name, NULL, &count, out);
    for (int e = 0; e < engine_count; e++)
        list_lightings(engines[e], &count, out);
}

char *neph_light_models_list(void)
{
    char *words = NULL;
    (void)neph_write_to_text(list_models, NULL, &words, NULL);
    return words;
}

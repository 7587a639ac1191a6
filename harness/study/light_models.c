/* SPDX-License-Identifier: MIT */
#include "harness/study/light_models.h"

#include "harness/engines/engines.h"
#include "harness/engines/look.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- by name --------------------------------------------------------------------------------- */

static enum neph_status set_number(struct neph_light_model *model, const char *key, int value,
                                   struct neph_diag *diag)
{
    char assignment[48];
    snprintf(assignment, sizeof(assignment), "%s=%d", key, value);
    return neph_settings_set(model->engine, &model->settings, assignment, diag);
}

/* What all models have alike; a preset has its own steps, and is given these. */
static enum neph_status set_common(struct neph_light_model *model, int steps,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (neph_option_find(model->engine->options, "steps") >= 0)
        status = set_number(model, "steps", steps, diag);
    if (!status && neph_option_find(model->engine->options, "warm_up") >= 0)
        status = set_number(model, "warm_up", NEPH_LIGHT_WARM_UP, diag);
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
    if (!engine || engine->rung != NEPH_RUNG_MODEL) {
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' is no lighting model", name);
        neph_hint(diag, "march, march_octaves and the other engines called march_; "
                        "realtime+lighting=WORD");
        return NEPH_ERR_USAGE;
    }
    model->engine = engine;
    model->settings = neph_settings_default(engine);
    neph_engine_probe(engine, device, &model->info);
    return NEPH_OK;
}

/* Each '+' ends a word. */
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

/* ---- what stands for what -------------------------------------------------------------------- */

bool neph_light_model_is_look(const struct neph_light_model *model)
{
    return neph_is_look(model->engine, &model->settings);
}

/* ---- all of them ----------------------------------------------------------------------------- */

/* The models of one engine, each with a comma before it; `*count` goes on. */
typedef void lister(const struct neph_engine *engine, int *count, FILE *out);

static bool has_room(int *count)
{
    return (*count)++ < NEPH_LIGHT_MODELS_MAX;
}

static void list_engine(const struct neph_engine *engine, int *count, FILE *out)
{
    if (engine->rung == NEPH_RUNG_MODEL && !engine->shortcut_of && !engine->is_narrow &&
        has_room(count))
        fprintf(out, "%s%s", *count > 1 ? "," : "", engine->name);
}

static void list_lightings(const struct neph_engine *engine, int *count, FILE *out)
{
    const int index = neph_option_find(engine->options, "lighting");
    if (engine->rung != NEPH_RUNG_MODEL || index < 0)
        return;
    const struct neph_option *option = &engine->options[index];
    for (int i = 1; option->choices && option->choices[i - 1] && option->choices[i]; i++)
        if (!neph_engine_lit_like(option->choices[i]) && has_room(count))
            fprintf(out, "%s%s+lighting=%s", *count > 1 ? "," : "", engine->name,
                    option->choices[i]);
}

char *neph_light_models_offered(void)
{
    static lister *const listers[] = {list_engine, list_lightings};
    char *words = NULL;
    size_t size;
    int engine_count, count = 0;
    const struct neph_engine *const *engines = neph_engines(&engine_count);
    FILE *out = open_memstream(&words, &size);
    if (!out)
        return NULL;
    for (size_t i = 0; i < sizeof(listers) / sizeof(listers[0]); i++)
        for (int e = 0; e < engine_count; e++)
            listers[i](engines[e], &count, out);
    const bool cut = ferror(out) != 0, closed = fclose(out) == 0;
    if (!cut && closed)
        return words;
    free(words);
    return NULL;
}

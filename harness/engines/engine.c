/* SPDX-License-Identifier: MIT */
#include "harness/engines/engine.h"

#include "base/build_id.h"
#include "base/text.h"
#include "renderer/sky/split.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_LEVEL_COUNT == 4, "a new kind");

static const char *const rung_names[] = {
    [NEPH_LEVEL_EXACT] = "exact",
    [NEPH_LEVEL_TRACER] = "tracer",
    [NEPH_LEVEL_EXTERNAL] = "witness",
    [NEPH_LEVEL_MODEL] = "model",
};

const char *neph_reference_level_name(enum neph_reference_level rung)
{
    return rung_names[rung];
}

/* Built-in engines take neph's own build id: a change of code or shaders makes a different frame,
 * even if the engine's version was not raised. */
static void name_own_build(struct neph_engine_info *info)
{
    char id[NEPH_BUILD_ID_SIZE];
    struct neph_diag diag = {0};
    if (info->build[0] || !info->available)
        return;
    if (neph_build_id(id, &diag) == NEPH_OK) {
        snprintf(info->build, sizeof(info->build), "%s", id);
        return;
    }
    info->available = false;
    info->broken = true;
    snprintf(info->missing, sizeof(info->missing), "its build is not known: %.400s", diag.message);
}

void neph_engine_probe(const struct neph_engine *engine, struct neph_shared_device *device,
                       struct neph_engine_info *info)
{
    engine->probe(engine, device, info);
    name_own_build(info);
    neph_text_clean(info->version, sizeof(info->version));
    neph_text_clean(info->device, sizeof(info->device));
    neph_text_clean(info->missing, sizeof(info->missing));
    neph_text_clean(info->warning, sizeof(info->warning));
    neph_text_clean(info->can, sizeof(info->can));
    neph_text_clean(info->install_line, sizeof(info->install_line));
}

bool neph_engine_can_render(const struct neph_engine *engine, const struct neph_scene *scene,
                            const struct neph_settings *settings, char *reason, size_t reason_size)
{
    return engine->can_render(scene, settings, reason, reason_size) &&
           !(engine->lacks && engine->lacks(engine, scene, settings, reason, reason_size));
}

enum neph_status neph_engine_check_size(const struct neph_engine *engine, int width_px,
                                        int height_px, struct neph_diag *diag)
{
    const int most = engine->side_max_px > 0 ? engine->side_max_px : NEPH_IMAGE_SIDE_MAX_PX;
    if (width_px <= most && height_px <= most)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "%s renders sides of 1..%d pixels, not %d x %d", engine->name,
              most, width_px, height_px);
    neph_hint(diag, "give a smaller --size");
    return NEPH_ERR_USAGE;
}

bool neph_engine_has_steps(const struct neph_engine *engine, const struct neph_engine_info *info,
                           const struct neph_settings *settings)
{
    return engine->step.option && (!engine->step.is_taken || engine->step.is_taken(info, settings));
}

bool neph_engine_is_kind(const struct neph_engine *engine, const char *name)
{
    return strcmp(engine->first ? engine->first->name : engine->name, name) == 0;
}

struct neph_settings neph_settings_default(const struct neph_engine *engine)
{
    return neph_options_default(engine->options);
}

enum neph_status neph_settings_set(const struct neph_engine *engine, struct neph_settings *settings,
                                   const char *assignment, struct neph_diag *diag)
{
    char owner[64];
    const char *named = neph_settings_match_engine(engine, assignment);
    snprintf(owner, sizeof(owner), "engine %s", engine->name);
    const enum neph_status status = neph_options_set(engine->options, owner,
                                                     named ? named : assignment, settings, diag);
    if (status && diag && !diag->hint[0])
        neph_hint(diag, "`neph engines %s` explains its settings", engine->name);
    return status;
}

const char *neph_settings_match_engine(const struct neph_engine *engine, const char *text)
{
    const size_t length = strlen(engine->name);
    const bool is_for_it = strncmp(text, engine->name, length) == 0 && text[length] == ':';
    return is_for_it ? text + length + 1 : NULL;
}

enum neph_status neph_settings_preset(const struct neph_engine *engine, const char *name,
                                      struct neph_settings *settings, struct neph_diag *diag)
{
    char owner[64];
    snprintf(owner, sizeof(owner), "engine %s", engine->name);
    return neph_options_preset(engine->options, owner, engine->presets, name, settings, diag);
}

enum neph_status neph_settings_parse_words(const struct neph_engine *engine, const char *words,
                                           const char *shared, struct neph_settings *settings,
                                           struct neph_diag *diag)
{
    char *text = strdup(words), *rest = text;
    enum neph_status status = text
                                  ? neph_settings_preset(engine, strsep(&rest, "+"), settings, diag)
                                  : neph_fail_memory(diag);
    if (!status && shared)
        status = neph_settings_set(engine, settings, shared, diag);
    while (rest && !status)
        status = neph_settings_set(engine, settings, strsep(&rest, "+"), diag);
    free(text);
    return status;
}

void neph_settings_adapt_to_scene(const struct neph_engine *engine, const struct neph_scene *scene,
                                  struct neph_settings *settings)
{
    struct neph_sky_split split;
    char reason[256];
    if (neph_option_find(engine->options, "sky") >= 0 &&
        neph_sky_split(scene, &split, reason, sizeof(reason)) &&
        !engine->can_render(scene, settings, reason, sizeof(reason)))
        (void)neph_settings_set(engine, settings, "sky=tables", NULL);
}

const char *neph_engine_other_lighting(const struct neph_engine *engine,
                                       const struct neph_scene *scene,
                                       const struct neph_settings *settings)
{
    const int lighting = neph_option_find(engine->options, "lighting");
    const char *const *words = lighting < 0 ? NULL : engine->options[lighting].choices;
    for (int i = 0; words && words[i]; i++) {
        struct neph_settings other = *settings;
        char ignored[256];
        other.values[lighting] = i;
        if (engine->can_render(scene, &other, ignored, sizeof(ignored)))
            return words[i];
    }
    return NULL;
}

double neph_setting(const struct neph_engine *engine, const struct neph_settings *settings,
                    const char *name)
{
    const int index = neph_option_find(engine->options, name);
    return index < 0 ? NAN : settings->values[index];
}

int neph_engine_samples(const struct neph_engine *engine)
{
    return engine->stochastic ? neph_option_find(engine->options, "samples") : -1;
}

char *neph_settings_text(const struct neph_engine *engine, const struct neph_settings *settings)
{
    return neph_options_text(engine->options, settings);
}

const char *neph_settings_origin(const struct neph_engine *engine, const char *preset)
{
    const struct neph_preset *named = engine->presets;
    while (!preset && named && named->name && named->assignments[0])
        named++;
    return preset || !named ? preset : named->name;
}

char *neph_settings_changes(const struct neph_engine *engine, const struct neph_settings *settings,
                            const char *preset)
{
    struct neph_settings from = neph_settings_default(engine);
    if (preset && neph_settings_preset(engine, preset, &from, NULL))
        return NULL;
    return neph_options_changes(engine->options, settings, &from);
}

/* SPDX-License-Identifier: MIT
 *
 * Selects the scenarios, columns and rows of a run.
 */
#include "harness/stress/suite.h"

#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/stress/floors.h"
#include "harness/stress/measures.h"
#include "harness/stress/truth.h"
#include "renderer/realtime/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a measure is added, as the plan treats bad values separately. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");

static const char *const engines[] = {"march", "fog_look", "cycles", "povray"};
/* Limit of every scenario, also without one in its file. */
static const struct neph_failing_limit no_bad_values = {
    .measure = NEPH_FAILING_BAD_VALUES,
    .over = (char[]){"all"},
    .limit = 0.0,
    .reason = (char[]){"a value that is not finite stays in a history for ever, and light is not "
                       "negative"},
};

/* --- Presets --- */

/* Whether the scene names the preset, or the preset on which it is based. */
static bool has_preset(const struct neph_failing *failing, const char *preset)
{
    const char *word = failing->presets;
    while (*word) {
        const size_t length = strcspn(word, " ");
        if (length > 0 && strncmp(preset, word, length) == 0 &&
            (preset[length] == '\0' || preset[length] == '+'))
            return true;
        word += length + (word[length] == ' ');
    }
    return failing->presets[0] == '\0';
}

static enum neph_status find_preset(const char *words, const struct neph_engine **engine,
                                    struct neph_diag *diag)
{
    struct neph_settings settings;
    return neph_engine_parse_words(words, "steps=8", engine, &settings, diag);
}

/* --- Columns --- */

bool neph_stress_measures(const struct neph_failing *failing,
                          const struct neph_failing_limit *limit,
                          const struct neph_stress_column *column)
{
    if (column->engine->is_user_engine)
        return true;
    if (column->is_preset)
        return has_preset(failing, column->name);
    return failing->engines && !neph_stress_measure(limit->measure)->over_time;
}

static enum neph_status find_engine(const char *name, const struct neph_engine **found,
                                    struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(name);
    if (!engine)
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'; `neph engines` lists them",
                         name);
    if (engine->has_frame_history)
        return neph_fail(diag, NEPH_ERR_USAGE, "%s takes part by its presets: --preset", name);
    if (engine->rung == NEPH_LEVEL_EXACT)
        return neph_fail(diag, NEPH_ERR_USAGE, "%s is the reference of engines here", name);
    *found = engine;
    return NEPH_OK;
}

static enum neph_status add_column(struct neph_stress_suite *suite, const char *name,
                                   bool is_preset, struct neph_diag *diag)
{
    if (suite->column_count == NEPH_STRESS_COLUMNS_MAX)
        return neph_fail(diag, NEPH_ERR_USAGE, "more than %d presets and engines",
                         NEPH_STRESS_COLUMNS_MAX);
    const struct neph_engine *engine;
    const enum neph_status status = (is_preset ? find_preset : find_engine)(name, &engine, diag);
    if (!status)
        suite->columns[suite->column_count++] = (struct neph_stress_column){name, engine,
                                                                            is_preset};
    return status;
}

static bool has_engines(const struct neph_stress_suite *suite)
{
    bool has = false;
    for (int s = 0; s < suite->scene_count; s++)
        has |= suite->scenes[s]->failing->engines;
    return has;
}

#define COUNT(list) ((int)(sizeof(list) / sizeof((list)[0])))

/* Chooses the named columns, or by default the tier's presets, and engines if a scenario is for
 * engines. */
static enum neph_status choose_columns(const struct neph_stress_params *params,
                                       struct neph_stress_suite *suite, struct neph_diag *diag)
{
    const bool is_default = params->preset_count == 0 && params->engine_count == 0;
    const unsigned use = params->full ? NEPH_RT_STRESS_FULL : NEPH_RT_STRESS_QUICK;
    const struct neph_preset *preset;
    enum neph_status status = NEPH_OK;
    int known;
    const struct neph_engine *const *all = neph_engines(&known);
    for (int i = 0;
         is_default && !status && (preset = neph_preset_find_by_use(neph_rt_presets, use, i)); i++)
        status = add_column(suite, preset->name, true, diag);
    for (int i = 0; is_default && has_engines(suite) && i < COUNT(engines) && !status; i++)
        status = add_column(suite, engines[i], false, diag);
    for (int i = 0; is_default && has_engines(suite) && i < known && !status; i++)
        if (all[i]->first) /* further versions of Blender */
            status = add_column(suite, all[i]->name, false, diag);
    for (int i = 0; i < params->preset_count && !status; i++)
        status = add_column(suite, params->presets[i], true, diag);
    for (int i = 0; i < params->engine_count && !status; i++)
        status = add_column(suite, params->engines[i], false, diag);
    if (!status && !is_default && params->preset_count == 0 && !has_engines(suite)) {
        neph_fail(diag, NEPH_ERR_USAGE, "no scenario is for engines");
        neph_hint(diag, "scenarios with `engines: true`: fog_seam, fog_none, fog_below, elevator, "
                        "fog_look_...; others are for presets (--preset)");
        return NEPH_ERR_USAGE;
    }
    return status;
}

/* --- Scenarios --- */

/* Checks that the presets a scenario names exist. "none": the scenario is for no preset. */
static enum neph_status check_scene(const struct neph_scene *scene, struct neph_diag *diag)
{
    const struct neph_engine *engine;
    if (strcmp(scene->failing->presets, "none") == 0)
        return NEPH_OK;
    char *words = strdup(scene->failing->presets), *rest = words;
    enum neph_status status = words ? NEPH_OK : neph_fail_memory(diag);
    for (const char *word; !status && (word = strsep(&rest, " "));)
        if (*word && find_preset(word, &engine, diag)) {
            status = neph_fail(diag, NEPH_ERR_INPUT, "failure.presets: there is no preset '%s'",
                               word);
            neph_locate(diag, scene->path, 1, 1);
        }
    free(words);
    return status;
}

static enum neph_status add_scene(const struct neph_stress_params *params, const char *name,
                                  struct neph_stress_suite *suite, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    bool is_chosen = params->only_count == 0;
    for (int i = 0; i < params->only_count; i++)
        is_chosen |= strcmp(params->only[i], name) == 0;
    enum neph_status status = is_chosen ? neph_data_load_scene(name, &scene, diag) : NEPH_OK;
    if (status || !is_chosen)
        return status;
    is_chosen = scene->failing->fails &&
                (params->only_count > 0 || params->full || scene->failing->quick);
    status = is_chosen ? check_scene(scene, diag) : NEPH_OK;
    if (is_chosen && !status)
        suite->scenes[suite->scene_count++] = scene;
    else
        neph_scene_destroy(scene);
    return status;
}

static enum neph_status check_only(const struct neph_stress_params *params,
                                   const struct neph_stress_suite *suite, struct neph_diag *diag)
{
    for (int i = 0; i < params->only_count; i++) {
        bool found = false;
        for (int s = 0; s < suite->scene_count; s++)
            found |= strcmp(suite->scenes[s]->name, params->only[i]) == 0;
        if (found)
            continue;
        neph_fail(diag, NEPH_ERR_USAGE, "there is no scenario '%s'", params->only[i]);
        neph_hint(diag, "scenarios are the scenes of scenes/stress; `neph scenes` lists them");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

static enum neph_status choose_scenes(const struct neph_stress_params *params,
                                      struct neph_stress_suite *suite, struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    enum neph_status status = neph_data_list_scenes(NEPH_DATA_STRESS, &names, &count, diag);
    suite->scenes = neph_arena_allocate(&suite->arena, (size_t)count, sizeof(*suite->scenes));
    if (!status)
        status = neph_arena_check(&suite->arena, diag);
    for (int i = 0; i < count && !status; i++)
        status = add_scene(params, names[i], suite, diag);
    neph_data_free_names(names);
    return status ? status : check_only(params, suite, diag);
}

/* --- Rows --- */

static int point_count(const struct neph_stress_params *params, const struct neph_scene *scene)
{
    return params->full ? neph_failing_point_count(scene->failing) : 1;
}

static void add_row(struct neph_stress_suite *suite, const struct neph_scene *scene, int point,
                    const char *name, const struct neph_failing_limit *limit)
{
    struct neph_stress_row *row = &suite->rows[suite->row_count++];
    *row = (struct neph_stress_row){
        .scene = scene,
        .point_index = point,
        .point = name,
        .limit = limit,
        .is_moving = !neph_stress_is_static(scene),
        .cells = neph_arena_allocate(
            &suite->arena, (size_t)(suite->column_count + suite->floor_count), sizeof(*row->cells)),
    };
    for (int c = 0; c < suite->column_count && row->cells; c++)
        row->cells[c] = (struct neph_stress_cell){
            .value = NAN,
            .verdict = neph_stress_measures(scene->failing, limit, &suite->columns[c])
                           ? NEPH_STRESS_NOT_YET
                           : NEPH_STRESS_NOT_PLANNED,
            .why = ""};
    if (row->cells)
        neph_stress_plan_floor_cells(suite, row);
}

/* Adds the rows of a point; bad values are counted at every point. */
static void add_point(const struct neph_stress_params *params, struct neph_stress_suite *suite,
                      const struct neph_scene *scene, int point)
{
    const bool judges_all = params->width_px == 0 && !params->on_device;
    bool has_bad_values = false;
    char text[NEPH_FAILING_POINT_SIZE];
    neph_failing_point_name(scene->failing, point, text, sizeof(text));
    const char *name = neph_arena_copy_text(&suite->arena, text);
    for (int i = 0; i < scene->failing->limit_count; i++) {
        const struct neph_failing_limit *limit = &scene->failing->limits[i];
        const bool is_of_bad_values = limit->measure == NEPH_FAILING_BAD_VALUES;
        has_bad_values |= is_of_bad_values;
        if (judges_all || is_of_bad_values)
            add_row(suite, scene, point, name, limit);
    }
    if (!has_bad_values)
        add_row(suite, scene, point, name, &no_bad_values);
}

static enum neph_status make_rows(const struct neph_stress_params *params,
                                  struct neph_stress_suite *suite, struct neph_diag *diag)
{
    size_t most = 0;
    for (int s = 0; s < suite->scene_count; s++)
        most += (size_t)point_count(params, suite->scenes[s]) *
                (size_t)(suite->scenes[s]->failing->limit_count + 1);
    suite->rows = neph_arena_allocate(&suite->arena, most, sizeof(*suite->rows));
    for (int s = 0; s < suite->scene_count && suite->rows; s++)
        for (int point = 0; point < point_count(params, suite->scenes[s]); point++)
            add_point(params, suite, suite->scenes[s], point);
    return neph_arena_check(&suite->arena, diag);
}

enum neph_status neph_stress_plan(const struct neph_stress_params *params,
                                  struct neph_stress_suite *suite, struct neph_diag *diag)
{
    suite->full = params->full;
    suite->width_px = params->width_px;
    suite->on_device = params->on_device;
    suite->height_px = params->height_px;
    enum neph_status status = choose_scenes(params, suite, diag);
    if (!status)
        status = choose_columns(params, suite, diag);
    if (!status && (params->full || params->only_count > 0))
        status = neph_stress_add_floors(suite, diag);
    return status ? status : make_rows(params, suite, diag);
}

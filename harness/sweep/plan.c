/* SPDX-License-Identifier: MIT
 *
 * Sweep plans: the YAML schema, points of series, settings of points.
 */
#include "harness/sweep/plan.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "scenes/fields.h"

#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as scattering_words needs it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

#define PLAN(member) offsetof(struct neph_sweep_plan, member)
#define SERIES(member) offsetof(struct neph_sweep_series, member)

enum { TEXT_MAX = 200, NAME_MAX = 32, SIDE_MAX_PX = 8192, DEPTH_MAX = 4 };

/* --- values of series ----------------------------------------------------------------------- */

/* Reads the next word and advances `*rest`; false: no more words. */
static bool next_word(const char **rest, char *word, size_t size)
{
    *rest += strspn(*rest, " ");
    const size_t length = strcspn(*rest, " ");
    snprintf(word, size, "%.*s", (int)length, *rest);
    *rest += length;
    return length > 0;
}

int neph_sweep_value_count(const struct neph_sweep_series *series)
{
    char word[NEPH_SWEEP_LABEL_SIZE];
    int count = 0;
    for (const char *rest = series->values; rest && next_word(&rest, word, sizeof(word));)
        count++;
    return series->varied ? count : 1;
}

void neph_sweep_value(const struct neph_sweep_series *series, int index,
                      char label[NEPH_SWEEP_LABEL_SIZE])
{
    char word[NEPH_SWEEP_LABEL_SIZE / 2] = "";
    const char *rest = series->values;
    label[0] = '\0';
    if (!series->varied)
        return;
    for (int i = 0; i <= index; i++)
        next_word(&rest, word, sizeof(word));
    snprintf(label, NEPH_SWEEP_LABEL_SIZE, "%.38s=%s", series->varied, word);
}

bool neph_sweep_has_lag(const struct neph_sweep_series *series, int index)
{
    char label[NEPH_SWEEP_LABEL_SIZE], word[NEPH_SWEEP_LABEL_SIZE / 2];
    neph_sweep_value(series, index, label);
    const char *value = strchr(label, '=');
    bool found = false;
    for (const char *rest = series->lag_at; value && rest && next_word(&rest, word, sizeof(word));)
        found |= strcmp(word, value + 1) == 0;
    return found;
}

/* --- engines and settings ------------------------------------------------------------------- */

enum neph_scattering neph_sweep_scattering(const struct neph_sweep_series *series,
                                           const struct neph_scene *scene)
{
    return series->scattering < 0 ? scene->scattering : (enum neph_scattering)series->scattering;
}

const struct neph_engine *neph_sweep_engine(const struct neph_sweep_plan *plan,
                                            const struct neph_sweep_series *series,
                                            enum neph_scattering scattering)
{
    char name[64];
    snprintf(name, sizeof(name), "march_%.40s", plan->light);
    if (scattering == NEPH_SCATTERING_MULTIPLE && strcmp(series->engine, "march") == 0)
        return neph_engine_find(name);
    return neph_engine_find(series->engine);
}

static bool has_setting_word(const char *words, const char *key)
{
    const char *found = words ? strstr(words, key) : NULL;
    return found && found[strlen(key)] == '=';
}

/* Sets the plan's lighting, unless the series names one. */
static enum neph_status set_light(const struct neph_sweep_plan *plan,
                                  const struct neph_sweep_series *series,
                                  const struct neph_engine *engine, struct neph_settings *settings,
                                  struct neph_diag *diag)
{
    const int lighting = neph_option_find(engine->options, "lighting");
    char words[64];
    snprintf(words, sizeof(words), "lighting=%.40s", plan->light);
    if (lighting < 0 || has_setting_word(series->preset, "lighting") ||
        has_setting_word(series->held, "lighting") ||
        (series->varied && strcmp(series->varied, "lighting") == 0))
        return NEPH_OK;
    return neph_settings_set(engine, settings, words, diag);
}

static enum neph_status set_words(const struct neph_engine *engine, const char *words,
                                  struct neph_settings *settings, struct neph_diag *diag)
{
    char word[TEXT_MAX + 1];
    enum neph_status status = NEPH_OK;
    for (const char *rest = words; rest && !status && next_word(&rest, word, sizeof(word));)
        status = neph_settings_set(engine, settings, word, diag);
    return status;
}

enum neph_status neph_sweep_settings(const struct neph_sweep_plan *plan,
                                     const struct neph_sweep_series *series, int index,
                                     enum neph_scattering scattering,
                                     struct neph_settings *settings, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_sweep_engine(plan, series, scattering);
    char label[NEPH_SWEEP_LABEL_SIZE];
    enum neph_status status = NEPH_OK;
    *settings = neph_settings_default(engine);
    if (series->preset)
        status = neph_settings_parse_words(engine, series->preset, NULL, settings, diag);
    if (!status && scattering == NEPH_SCATTERING_MULTIPLE)
        status = set_light(plan, series, engine, settings, diag);
    if (!status)
        status = set_words(engine, series->held, settings, diag);
    neph_sweep_value(series, index, label);
    return status || !label[0] ? status : neph_settings_set(engine, settings, label, diag);
}

/* --- the file ------------------------------------------------------------------------------- */

/* Checks the settings against the engines' tables, for single and multiple scattering. */
static enum neph_status check_series(const struct neph_reader *reader,
                                     const struct neph_sweep_plan *plan, int number)
{
    static const enum neph_scattering both[] = {NEPH_SCATTERING_SINGLE, NEPH_SCATTERING_MULTIPLE};
    const struct neph_sweep_series *series = &plan->series[number];
    char quote[NEPH_QUOTE_SIZE];
    if (!neph_engine_find(series->engine))
        return neph_refuse(reader, neph_format_path("series[%d].engine", number).text,
                           "there is no engine '%s'; `neph engines` lists them",
                           neph_document_quote(series->engine, quote));
    if (!series->varied != !series->values)
        return neph_refuse(reader, neph_format_path("series[%d]", number).text,
                           "'vary' and 'values' need each other");
    if (neph_sweep_value_count(series) < 1 ||
        neph_sweep_value_count(series) > NEPH_SWEEP_VALUES_MAX)
        return neph_refuse(reader, neph_format_path("series[%d].values", number).text,
                           "give 1 to %d values, separated by spaces", NEPH_SWEEP_VALUES_MAX);
    for (int i = 0; i < neph_sweep_value_count(series); i++)
        for (size_t k = 0; k < sizeof(both) / sizeof(both[0]); k++) {
            struct neph_settings settings;
            struct neph_diag why = {.line = 0};
            if (neph_sweep_settings(plan, series, i, both[k], &settings, &why)) {
                neph_refuse(reader, neph_format_path("series[%d]", number).text, "%s", why.message);
                neph_hint(reader->diag, "%s", why.hint);
                return NEPH_ERR_INPUT;
            }
        }
    for (int other = 0; other < number; other++)
        if (strcmp(plan->series[other].name, series->name) == 0)
            return neph_refuse(reader, neph_format_path("series[%d].name", number).text,
                               "a second series '%s'", neph_document_quote(series->name, quote));
    return NEPH_OK;
}

static enum neph_status check_plan(struct neph_reader *reader, enum neph_status so_far, void *plan_)
{
    const struct neph_sweep_plan *plan = plan_;
    char engine[64], quote[NEPH_QUOTE_SIZE];
    if (so_far)
        return so_far;
    snprintf(engine, sizeof(engine), "march_%.40s", plan->light);
    if (!neph_engine_find(engine))
        return neph_refuse(reader, "light",
                           "there is no light '%s': it is the X of an engine "
                           "march_X, such as octaves or traced",
                           neph_document_quote(plan->light, quote));
    if (plan->frame_count % 4 != 0)
        return neph_refuse(reader, "frames", "%d frames are no multiple of 4", plan->frame_count);
    if (plan->warm_up % 4 != 0 || plan->frame_count - plan->warm_up < NEPH_SWEEP_FRAMES_MIN)
        return neph_refuse(reader, "warm_up",
                           "%d frames are no multiple of 4, or leave fewer than %d of %d",
                           plan->warm_up, NEPH_SWEEP_FRAMES_MIN, plan->frame_count);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < plan->series_count && !status; i++)
        status = check_series(reader, plan, i);
    return status;
}

/* One entry more than enum neph_scattering: 0, the default, is the scene's own scattering. */
static const char *const scattering_words[] = {"scene", "none", "single", "multiple", NULL};

static enum neph_status read_series(struct neph_reader *reader, const yaml_node_t *node,
                                    const struct neph_record *record, void *target)
{
    struct neph_sweep_series *series = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    series->scattering--;
    return status;
}

static const struct neph_field series_fields[] = {
    {"name", NEPH_TEXT, SERIES(name), .note = "in tables and legends", .least = 1,
     .most = NAME_MAX},
    {"engine", NEPH_TEXT, SERIES(engine), .note = "one of `neph engines`", .least = 1,
     .most = NAME_MAX},
    {"preset", NEPH_TEXT, SERIES(preset), .note = "PRESET or PRESET+KEY=VALUE+...", .least = 1,
     .most = TEXT_MAX, .standard = "none"},
    {"set", NEPH_TEXT, SERIES(held), .note = "KEY=VALUE, separated by spaces, for all points",
     .least = 1, .most = TEXT_MAX, .standard = "none"},
    {"vary", NEPH_TEXT, SERIES(varied), .note = "the setting that varies along the line",
     .least = 1, .most = NAME_MAX, .standard = "none"},
    {"values", NEPH_TEXT, SERIES(values), .note = "of that setting, separated by spaces",
     .least = 1, .most = TEXT_MAX, .standard = "none"},
    {"flicker", NEPH_FLAG, SERIES(flicker),
     .note = "render a sequence and measure its flicker; engines with a history always render one",
     .standard = "`false`"},
    {"lag_at", NEPH_TEXT, SERIES(lag_at),
     .note = "values for which the lag after a step of the sun is measured, too", .least = 1,
     .most = TEXT_MAX, .standard = "none"},
    {"scattering", NEPH_WORD, SERIES(scattering),
     .note =
         "render the scene with these orders of scattering; the missing light is part of the error",
     .words = scattering_words, .standard = "`scene`"},
    {"order", NEPH_NUMBER, SERIES(order), "", 0, 8,
     .note = "error ~ time^-order, drawn as the expected slope; 0: not drawn", .standard = "0"},
    {0},
};

static const struct neph_record series_record = {
    .size = sizeof(struct neph_sweep_series), .fields = series_fields, .read = read_series};

static const struct neph_field plan_fields[] = {
    {"title", NEPH_TEXT, PLAN(title), .least = 1, .most = TEXT_MAX},
    {"light", NEPH_TEXT, PLAN(light),
     .note = "X of march_X and of lighting=X, for series that set no lighting, in scenes with all "
             "orders of scattering",
     .least = 1, .most = NAME_MAX},
    {"width_px", NEPH_WHOLE, PLAN(width_px), "", 16, SIDE_MAX_PX, .note = "of the frames"},
    {"height_px", NEPH_WHOLE, PLAN(height_px), "", 9, SIDE_MAX_PX, .note = "of the frames"},
    {"frames", NEPH_WHOLE, PLAN(frame_count), "", NEPH_SWEEP_FRAMES_MIN, 4096,
     .note = "of sequences, a multiple of 4"},
    {"warm_up", NEPH_WHOLE, PLAN(warm_up), "", 0, 4096,
     .note = "frames at the start that are not measured"},
    {"truth_samples", NEPH_WHOLE, PLAN(truth_samples), "", 4, 1 << 20,
     .note = "paths per pixel of the truth, where `exact` cannot render the scene"},
    {"rounds", NEPH_WHOLE, PLAN(round_count), "", 1, 99,
     .note = "every point is timed once in each round"},
    {"seeds", NEPH_WHOLE, PLAN(seed_count), "", 1, NEPH_SWEEP_SEEDS_MAX,
     .note = "of each sequence: values are means over seeds, and intervals include their scatter; "
             "single frames use a seed per round",
     .standard = "1"},
    {"series", NEPH_LIST, PLAN(series), .least = 1, .most = NEPH_SWEEP_SERIES_MAX,
     .count_at = PLAN(series_count), .record = &series_record},
    {0},
};

static enum neph_status read_text(const char *path, const char *text, size_t size,
                                  struct neph_sweep_plan *plan, struct neph_diag *diag)
{
    struct neph_document document;
    enum neph_status status = neph_document_init(&document, path, text, size, DEPTH_MAX, diag);
    if (status)
        return status;
    plan->seed_count = 1;
    status = neph_read_document(&document, &plan->arena, plan_fields, check_plan, plan, diag);
    neph_document_finish(&document);
    return status;
}

/* The user's file, or a plan that is installed with neph. */
static char *find_file(const char *path_or_name)
{
    if (neph_path_exists(path_or_name))
        return strdup(path_or_name);
    char *relative = neph_format("scenes/studies/%s.yaml", path_or_name);
    char *path = relative ? neph_data_path(relative) : NULL;
    free(relative);
    return path;
}

enum neph_status neph_sweep_plan_load(const char *path_or_name, struct neph_sweep_plan *plan,
                                      struct neph_diag *diag)
{
    char *path = find_file(path_or_name), *text = NULL;
    size_t size = 0;
    *plan = (struct neph_sweep_plan){.title = NULL};
    if (!path)
        return neph_fail_memory(diag);
    enum neph_status status = neph_file_read(path, NEPH_DOCUMENT_MAX_BYTES, &text, &size, diag);
    if (!status)
        status = read_text(path, text, size, plan, diag);
    if (status)
        neph_sweep_plan_finish(plan);
    free(text);
    free(path);
    return status;
}

void neph_sweep_plan_finish(struct neph_sweep_plan *plan)
{
    neph_arena_finish(&plan->arena);
    *plan = (struct neph_sweep_plan){.title = NULL};
}

void neph_sweep_plan_print_keys(FILE *file)
{
    neph_fields_print(plan_fields, "", file);
}

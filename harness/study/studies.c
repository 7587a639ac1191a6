/* SPDX-License-Identifier: MIT
 *
 * The step studies that are installed with neph: reading, measuring, writing.
 */
#include "harness/study/studies.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char format[] = "neph-studies-1";

static char *studies_path(const struct neph_engine *engine)
{
    const char *kind = engine->first ? engine->first->name : engine->name;
    return neph_data_path(neph_path_format("scenes/studies/%s.json", kind).text);
}

/* The content of a file, or an empty list where the file does not exist. */
static enum neph_status load(const char *path, json_t **content, struct neph_diag *diag)
{
    json_error_t error;
    if (!neph_path_exists(path)) {
        *content = json_pack("{s:s, s:[]}", "format", format, "studies");
        return *content ? NEPH_OK : neph_fail_memory(diag);
    }
    json_t *loaded = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    const char *found = json_string_value(json_object_get(loaded, "format"));
    if (found && strcmp(found, format) == 0 && json_is_array(json_object_get(loaded, "studies"))) {
        *content = loaded;
        return NEPH_OK;
    }
    neph_fail(diag, NEPH_ERR_INPUT, "%s", loaded ? "this is no file of step studies" : error.text);
    neph_locate(diag, path, loaded ? 1 : error.line, loaded ? 1 : error.column);
    neph_hint(diag, "remove the file and make it again with `neph study --renew`");
    json_decref(loaded);
    return NEPH_ERR_INPUT;
}

static bool has_text(const json_t *entry, const char *key, const char *text)
{
    const char *value = json_string_value(json_object_get(entry, key));
    return value && strcmp(value, text) == 0;
}

static bool matches_job(const json_t *entry, const struct neph_job *job)
{
    return has_text(entry, "scene_hash", job->shot.scene->hash) &&
           has_text(entry, "version", job->info->version) &&
           json_integer_value(json_object_get(entry, "driver")) == (json_int_t)job->engine->version;
}

enum neph_status neph_studies_find(const struct neph_job *job, struct neph_study *study,
                                   bool *found, struct neph_diag *diag)
{
    json_t *content = NULL;
    char *path = studies_path(job->engine);
    enum neph_status status = path ? load(path, &content, diag) : neph_fail_memory(diag);
    const json_t *list = json_object_get(content, "studies");
    *found = false;
    for (size_t i = 0; i < json_array_size(list) && !*found && !status; i++) {
        const json_t *entry = json_array_get(list, i);
        if (!matches_job(entry, job))
            continue;
        status = neph_study_read(json_object_get(entry, "study"), job->engine, study, diag);
        study->is_shipped = *found = !status;
    }
    json_decref(content);
    free(path);
    return status;
}

enum neph_status neph_studies_make(const struct neph_job *job, struct neph_store *store,
                                   struct neph_study *study, enum neph_outcome *outcome,
                                   char reason[1600], struct neph_diag *diag)
{
    struct neph_job small = *job;
    small.shot.width_px = NEPH_STUDIES_WIDTH_PX;
    small.shot.height_px = NEPH_STUDIES_HEIGHT_PX;
    small.shot.layers = NEPH_LAYER_RADIANCE;
    const enum neph_status status = neph_study_run(&small, store, study, outcome, reason, diag);
    study->width_px = small.shot.width_px;
    study->height_px = small.shot.height_px;
    return status;
}

/* Index of the scene's entry, or the number of entries. */
static size_t find_scene_entry(const json_t *list, const char *scene)
{
    size_t i = 0;
    while (i < json_array_size(list) && !has_text(json_array_get(list, i), "scene", scene))
        i++;
    return i;
}

/* Writes one study per line, so that a diff is readable. */
static enum neph_status write_file(const char *path, const json_t *list, struct neph_diag *diag)
{
    char *text = neph_format("{\"format\": \"%s\", \"studies\": [\n", format);
    for (size_t i = 0; i < json_array_size(list) && text; i++) {
        char *line = json_dumps(json_array_get(list, i), JSON_REAL_PRECISION(9));
        const char *end = i + 1 < json_array_size(list) ? "," : "";
        char *longer = line ? neph_format("%s%s%s\n", text, line, end) : NULL;
        free(line);
        free(text);
        text = longer;
    }
    char *whole = text ? neph_format("%s]}\n", text) : NULL;
    const enum neph_status status = whole ? neph_file_write(path, whole, strlen(whole), diag)
                                          : neph_fail_memory(diag);
    free(whole);
    free(text);
    return status;
}

/* Adds a study, or replaces the one of the same scene. */
static enum neph_status install_study(const struct neph_job *job, const struct neph_study *study,
                                      struct neph_diag *diag)
{
    json_t *content = NULL;
    char *path = studies_path(job->engine);
    enum neph_status status = path ? load(path, &content, diag) : neph_fail_memory(diag);
    if (!status) {
        json_t *list = json_object_get(content, "studies");
        json_t *entry = json_pack("{s:s, s:s, s:s, s:i, s:o}", "scene", job->shot.scene->name,
                                  "scene_hash", job->shot.scene->hash, "version",
                                  job->info->version, "driver", (int)job->engine->version, "study",
                                  neph_study_json(study));
        const size_t place = find_scene_entry(list, job->shot.scene->name);
        const int failed = place < json_array_size(list) ? json_array_set_new(list, place, entry)
                                                         : json_array_append_new(list, entry);
        status = failed ? neph_fail_memory(diag) : write_file(path, list, diag);
    }
    json_decref(content);
    free(path);
    return status;
}

/* ---- renewing -------------------------------------------------------------------------------- */

struct work {
    double time_limit_s;
    struct neph_store *store;
    bool keeps;
    struct neph_progress progress;
};

/* `*word` is the result for the progress. */
static enum neph_status renew_study(const struct work *work, const struct neph_scene *scene,
                                    const struct neph_engine *engine, const char **word,
                                    struct neph_diag *diag)
{
    struct neph_engine_info info;
    neph_engine_probe(engine, NULL, &info);
    const struct neph_job job = {.engine = engine,
                                 .info = &info,
                                 .shot = {.scene = scene,
                                          .settings = neph_settings_default(engine),
                                          .seed = 1,
                                          .time_limit_s = work->time_limit_s}};
    struct neph_study study;
    bool is_there = false;
    enum neph_outcome outcome;
    char reason[1600];
    *word = "needs none";
    if (!neph_study_applies(engine, scene) ||
        !neph_engine_has_steps(engine, &info, &job.shot.settings))
        return NEPH_OK;
    enum neph_status status = neph_studies_find(&job, &study, &is_there, diag);
    *word = "is there";
    if (status || is_there)
        return status;
    status = neph_studies_make(&job, work->store, &study, &outcome, reason, diag);
    *word = outcome == NEPH_OUTCOME_RENDERED ? "studied" : neph_outcome_name(outcome);
    return !status && outcome == NEPH_OUTCOME_RENDERED && work->keeps
               ? install_study(&job, &study, diag)
               : status;
}

static bool is_studied(const struct neph_engine *engine)
{
    return engine->rung == NEPH_LEVEL_EXTERNAL && engine->step.option;
}

static enum neph_status renew_scene(struct work *work, const char *name, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    int engine_count;
    const struct neph_engine *const *engines = neph_engines(&engine_count);
    enum neph_status status = neph_data_load_scene(name, &scene, diag);
    if (status == NEPH_ERR_NOT_FOUND)
        return NEPH_OK;
    for (int i = 0; i < engine_count && !status; i++) {
        if (!is_studied(engines[i]))
            continue;
        char what[256];
        const char *word = "";
        snprintf(what, sizeof(what), "%s of %s", engines[i]->name, scene->name);
        work->progress.kind = i;
        neph_progress_begin(&work->progress, what);
        status = renew_study(work, scene, engines[i], &word, diag);
        if (!status)
            neph_progress_over(&work->progress, what, word);
    }
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_studies_renew(const char *const *scenes, int scene_count, double time_limit_s,
                                    struct neph_store *store, bool keeps, bool quiet,
                                    struct neph_diag *diag)
{
    int engine_count;
    const struct neph_engine *const *engines = neph_engines(&engine_count);
    struct work work = {.time_limit_s = time_limit_s,
                        .store = store,
                        .keeps = keeps,
                        .progress = neph_progress_start(quiet, 0)};
    for (int i = 0; i < engine_count; i++)
        if (is_studied(engines[i]))
            neph_progress_expect(&work.progress, i, scene_count, 0.0);
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene_count && !status; i++)
        status = renew_scene(&work, scenes[i], diag);
    neph_progress_end(&work.progress);
    return status;
}

/* SPDX-License-Identifier: MIT */
#include "harness/report/over_time.h"

#include "base/clock.h"
#include "base/files.h"
#include "harness/compare/measure.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/study/take.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 24, PRESETS = 2 };

/* Bars at the pitch of the tiles, at the size at which they are: where such methods fail. */
static const char scene_name[] = "fence_pitch4";
static const int width_px = 320, height_px = 180;
static const double pixels_per_degree = 60.0; /* as `neph flicker` */

/* The same for the march and its shortcut: the flicker is that of the rebuilding, and an eighth of
 * the default steps leaves time for the frames and for the rays of the reference. */
static const char shared_setting[] = "steps=8";
static const char *const presets[PRESETS] = {"seed", "ours"};

/* What a person sees, over the threshold. */
static const char map_file[] = "seen_contrast_radiance.png";

int neph_over_time_step_count(void)
{
    return 1 + PRESETS;
}

struct work {
    const struct neph_scene *scene;
    struct neph_store *store;
    struct neph_progress *progress;
    struct neph_reference reference;
};

/* `preset` NULL: the default, for what all presets have in common. */
static enum neph_status make_job(const struct work *work, struct neph_engine_info *info,
                                 const char *preset, struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find("realtime");
    neph_engine_probe(engine, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = work->scene,
                                      .settings = neph_settings_default(engine),
                                      .width_px = width_px,
                                      .height_px = height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = 1}};
    enum neph_status status = preset
                                  ? neph_settings_preset(engine, preset, &job->shot.settings, diag)
                                  : NEPH_OK;
    return status ? status : neph_settings_set(engine, &job->shot.settings, shared_setting, diag);
}

/* ---- one preset ------------------------------------------------------------------------------ */

/* The flicker against the reference, with its map, and the same against centre rays. */
static enum neph_status take_preset(const struct work *work, const struct neph_job *job,
                                    char **folder, json_t **record, struct neph_diag *diag)
{
    static const char *const extractors[] = {"seen", "flicker", NULL};
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = work->scene->exposure_ev;
    viewing.frame_rate_hz = work->scene->frame_rate_hz;
    viewing.pixels_per_degree = pixels_per_degree;
    const struct neph_reading readings[] = {
        {"flicker", NEPH_REFERENCE_AVERAGED, extractors, NULL, viewing},
        {"flicker_centre", NEPH_REFERENCE_CENTRE, extractors, NULL, viewing},
    };
    const struct neph_take take = {
        .job = *job,
        .frame_count = FRAMES,
        .reference = &work->reference,
        .readings = readings,
        .reading_count = sizeof(readings) / sizeof(readings[0]),
        .with_pictures = true,
        .map_file = map_file,
        .all_masks = true,
    };
    return neph_take_run(&take, work->store, folder, record, diag);
}

/* ---- rows of the report ---------------------------------------------------------------------- */

/* A number of all frames, with what it is against centre rays. */
static json_t *shown_number(const json_t *found, const json_t *beside)
{
    json_t *number = json_copy((json_t *)found);
    const json_t *value = json_object_get(beside, "value");
    neph_json_set(&number, "against_centre_rays",
                  value ? json_incref((json_t *)value) : json_null());
    return number;
}

/* What the report shows of the numbers of all frames. */
static json_t *shown_measurements(const json_t *document, const json_t *centre)
{
    static const char *const metrics[] = {"seen_contrast", "seen_share", "std_p95"};
    static const char *const masks[] = {"all", "depth_edge", "non_edge"};
    const json_t *all = json_object_get(document, "measurements");
    const json_t *all_centre = json_object_get(centre, "measurements");
    json_t *shown = json_array();
    for (size_t m = 0; m < sizeof(masks) / sizeof(masks[0]); m++)
        for (size_t k = 0; k < sizeof(metrics) / sizeof(metrics[0]); k++) {
            const json_t *found = neph_measurement_find(all, "radiance", metrics[k], masks[m]);
            const json_t *beside = neph_measurement_find(all_centre, "radiance", metrics[k],
                                                         masks[m]);
            if (found)
                neph_json_add(&shown, shown_number(found, beside));
        }
    return shown;
}

/* In words: of the whole picture and of its depth edges. */
static json_t *shown_findings(const json_t *document)
{
    const json_t *all = json_object_get(document, "findings");
    json_t *shown = json_array();
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *item = json_array_get(all, i);
        const char *mask = neph_json_text(item, "mask");
        if (strcmp(neph_json_text(item, "quantity"), "radiance") == 0 &&
            strcmp(neph_json_text(item, "finding"), "flicker") == 0 &&
            (strcmp(mask, "all") == 0 || strcmp(mask, "depth_edge") == 0))
            neph_json_add(&shown, json_incref((json_t *)item));
    }
    return shown;
}

static json_t *row_json(const char *preset, const struct neph_job *job, const char *folder,
                        const json_t *record, const json_t *document, const json_t *centre)
{
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    json_t *row = json_pack("{s:s, s:s, s:s, s:s, s:s?, s:O, s:s, s:o, s:o, s:[], s:n}", "engine",
                            job->engine->name, "preset", preset, "status", "rendered", "reason", "",
                            "settings", settings, "render_s", json_object_get(record, "render_s"),
                            "folder", folder, "measurements", shown_measurements(document, centre),
                            "findings", shown_findings(document), "pictures", "map");
    free(settings);
    return row;
}

static json_t *refusal_json(const char *preset, const struct neph_job *job, const char *status,
                            const char *reason)
{
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    json_t *row = json_pack("{s:s, s:s, s:s, s:s, s:s?, s:n, s:n, s:[], s:[], s:[], s:n}", "engine",
                            job->engine->name, "preset", preset, "status", status, "reason", reason,
                            "settings", settings, "render_s", "folder", "measurements", "findings",
                            "pictures", "map");
    free(settings);
    return row;
}

static enum neph_status run_preset(const struct work *work, const char *preset, json_t **row,
                                   struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    char *folder = NULL;
    json_t *record = NULL, *document = NULL, *centre = NULL;
    enum neph_status status = make_job(work, &info, preset, &job, diag);
    if (!status)
        status = take_preset(work, &job, &folder, &record, diag);
    if (!status)
        status = neph_take_document(folder, "flicker", &document, diag);
    if (!status)
        status = neph_take_document(folder, "flicker_centre", &centre, diag);
    if (!status && !(*row = row_json(preset, &job, folder, record, document, centre)))
        status = neph_fail_memory(diag);
    json_decref(document);
    json_decref(centre);
    json_decref(record);
    free(folder);
    return status;
}

/* What of an engine is news and not the end of the run; NULL: it is the end. */
static const char *refusal_of(enum neph_status status)
{
    return status == NEPH_ERR_UNAVAILABLE   ? "missing"
           : status == NEPH_ERR_UNSUPPORTED ? "cannot"
           : status == NEPH_ERR_ENGINE      ? "failed"
                                            : NULL;
}

/* A step of progress that is one preset; what an engine cannot becomes a row too. */
static enum neph_status add_preset(const struct work *work, const char *preset, json_t *rows,
                                   struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    json_t *row = NULL;
    enum neph_status status = run_preset(work, preset, &row, &why);
    const char *refusal = refusal_of(status);
    if (refusal) {
        struct neph_engine_info info;
        struct neph_job job;
        status = make_job(work, &info, preset, &job, diag);
        row = status ? NULL : refusal_json(preset, &job, refusal, why.message);
    } else if (status && diag) {
        *diag = why;
    }
    return status ? status : neph_json_append(rows, row, diag);
}

/* ---- the run --------------------------------------------------------------------------------- */

/* The reference in the words of the page; `status` is "rendered", or what `reason` explains. */
static json_t *reference_json(const struct work *work, const char *status, const char *reason)
{
    const struct neph_reference *made = &work->reference;
    const bool is_there = made->text != NULL;
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:o}", "engine", "march", "settings",
                     is_there ? made->settings : "", "text",
                     is_there ? made->text : "march, 16 rays a pixel", "status", status, "reason",
                     reason, "cpu_s", is_there ? json_real(made->cost.cpu_s) : json_null());
}

static json_t *sequence_json(const struct work *work, const char *status, const char *reason)
{
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:f, s:o, s:[]}", "scene",
                     work->scene->name, "title", work->scene->title, "physics",
                     work->scene->physics, "size_px", width_px, height_px, "frames", FRAMES,
                     "rate_hz", work->scene->frame_rate_hz, "exposure_ev", work->scene->exposure_ev,
                     "reference", reference_json(work, status, reason), "rows");
}

static enum neph_status run_presets(struct work *work, json_t *rows, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < PRESETS && !status; i++) {
        char what[128];
        snprintf(what, sizeof(what), "%d frames of %s with realtime, preset %s", FRAMES, scene_name,
                 presets[i]);
        neph_progress_begin(work->progress, what);
        const double start_s = neph_wall_s();
        status = add_preset(work, presets[i], rows, diag);
        const json_t *row = json_array_get(rows, json_array_size(rows) - 1);
        neph_progress_step(work->progress, what, status ? "" : neph_json_text(row, "status"),
                           neph_wall_s() - start_s);
    }
    return status;
}

/* Without a reference there is nothing to measure: the sequence then says why and has no rows. */
static enum neph_status run_sequence(struct work *work, json_t *list, struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    struct neph_progress unseen = neph_progress_start(true, 0); /* the whole is one step here */
    struct neph_diag why = {.line = 0};
    const double start_s = neph_wall_s();
    char what[128];
    snprintf(what, sizeof(what), "reference of %s with march", scene_name);
    neph_progress_begin(work->progress, what);
    enum neph_status status = make_job(work, &info, NULL, &job, &why);
    if (!status)
        status = neph_reference_make(&job, FRAMES, work->store, &unseen, &work->reference, &why);
    const char *word = status ? refusal_of(status) : "rendered";
    if (!word) {
        if (diag)
            *diag = why;
        return status;
    }
    neph_progress_step(work->progress, what, word, neph_wall_s() - start_s);
    json_t *sequence = sequence_json(work, word, status ? why.message : "");
    const enum neph_status added = neph_json_append(list, sequence, diag);
    return added || status ? added : run_presets(work, json_object_get(sequence, "rows"), diag);
}

enum neph_status neph_over_time_run(struct neph_store *store, struct neph_progress *progress,
                                    json_t *list, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(scene_name, &scene, diag);
    struct work work = {.scene = scene, .store = store, .progress = progress};
    if (!status)
        status = run_sequence(&work, list, diag);
    neph_reference_finish(&work.reference);
    neph_scene_destroy(scene);
    return status;
}

/* ---- the report's pictures ------------------------------------------------------------------- */

/* One file of the entry into the report; `*relative` (to free) is its path there. */
static enum neph_status copy_picture(const char *entry, const char *file, const char *report_folder,
                                     const char *scene, const char *preset, const char *name,
                                     json_t **relative, struct neph_diag *diag)
{
    char *from = neph_path_join(entry, file);
    char *path = neph_format("images/over_time/%s_%s_%s.png", scene, preset, name);
    char *to = path ? neph_path_join(report_folder, path) : NULL;
    enum neph_status status = from && to ? neph_file_copy(from, to, diag) : neph_fail_memory(diag);
    if (!status && !(*relative = json_string(path)))
        status = neph_fail_memory(diag);
    free(from);
    free(path);
    free(to);
    return status;
}

static enum neph_status copy_row(json_t *row, const char *scene, const char *report_folder,
                                 struct neph_diag *diag)
{
    const char *entry = json_string_value(json_object_get(row, "folder"));
    const char *preset = neph_json_text(row, "preset");
    json_t *pictures = json_array(), *map = NULL;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_TAKE_PICTURES && entry && !status; i++) {
        char file[32], name[16];
        snprintf(file, sizeof(file), "flip_%d.png", i);
        snprintf(name, sizeof(name), "%d", i);
        json_t *path = NULL;
        status = copy_picture(entry, file, report_folder, scene, preset, name, &path, diag);
        if (!status && json_array_append_new(pictures, path) != 0)
            status = neph_fail_memory(diag);
    }
    if (!status && entry)
        status = copy_picture(entry, map_file, report_folder, scene, preset, "seen", &map, diag);
    if (!status && (json_object_set(row, "pictures", pictures) != 0 ||
                    (map && json_object_set(row, "map", map) != 0)))
        status = neph_fail_memory(diag);
    json_decref(pictures);
    json_decref(map);
    return status;
}

enum neph_status neph_over_time_pictures(json_t *list, const char *report_folder,
                                         struct neph_diag *diag)
{
    char *folder = neph_path_join(report_folder, "images/over_time");
    enum neph_status status = folder ? NEPH_OK : neph_fail_memory(diag);
    if (!status && json_array_size(list) > 0)
        status = neph_dir_create(folder, diag);
    for (size_t i = 0; i < json_array_size(list) && !status; i++) {
        json_t *sequence = json_array_get(list, i), *rows = json_object_get(sequence, "rows");
        for (size_t r = 0; r < json_array_size(rows) && !status; r++)
            status = copy_row(json_array_get(rows, r), neph_json_text(sequence, "scene"),
                              report_folder, diag);
    }
    free(folder);
    return status;
}

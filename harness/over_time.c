/* SPDX-License-Identifier: MIT */
#include "harness/over_time.h"

#include "base/clock.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/png.h"
#include "harness/comparison.h"
#include "harness/data.h"
#include "harness/job.h"
#include "harness/json.h"
#include "harness/scene_layers.h"
#include "metrics/display.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 24, FLIPBOOK = 4, PRESETS = 2 };

/* Part of the key under which measurements are kept; raise it when a metric of flicker changes. */
enum { MEASURED_REVISION = 1 };

/* Bars at the pitch of the tiles, at the size at which they are: where such methods fail. */
static const char scene_name[] = "fence_pitch4";
static const int width_px = 320, height_px = 180;

/* The same for the march and its shortcut: the flicker is that of the rebuilding, and a quarter of
 * the default steps leaves time for the frames. */
static const char shared_setting[] = "steps=16";
static const char *const presets[PRESETS] = {"seed", "ours"};

int neph_over_time_step_count(void)
{
    return 1 + PRESETS;
}

struct work {
    const struct neph_scene *scene;
    struct neph_store *store;
    struct neph_progress *progress;
    char *reference_path; /* of the marched frame in the store */
};

static enum neph_status make_job(const struct work *work, const char *engine_name,
                                 struct neph_engine_info *info, const char *preset,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(engine_name);
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

static enum neph_status write_flip(const struct work *work, const struct neph_image *image,
                                   const char *folder, int phase, struct neph_diag *diag)
{
    float *planes[3];
    if (!neph_image_rgb(image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_ENGINE, "a frame of the sequence has no radiance");
    const float *const constant[3] = {planes[0], planes[1], planes[2]};
    uint8_t *rgb = malloc(3 * neph_image_pixel_count(image));
    char *path = neph_format("%s/flip_%d.png", folder, phase);
    enum neph_status status = rgb && path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_display_encode(constant, neph_image_pixel_count(image),
                                     work->scene->exposure_ev, rgb, diag);
    if (!status)
        status = neph_png_write_rgb8(path, image->width_px, image->height_px, rgb, diag);
    free(path);
    free(rgb);
    return status;
}

static char *frame_path(const char *folder, int frame)
{
    return neph_format("%s/frame_%04d.exr", folder, frame);
}

/* All frames into `folder`; of the last cycle pictures too. */
static enum neph_status render_frames(const struct work *work, struct neph_job *job,
                                      const char *folder, struct neph_cost *total,
                                      struct neph_diag *diag)
{
    job->shot.scratch_directory = folder;
    enum neph_status status = neph_job_open(job, diag);
    for (int i = 0; i < FRAMES && !status; i++) {
        struct neph_image *frame = NULL;
        struct neph_cost cost = {0};
        job->shot.frame = i;
        char *path = i == FRAMES - 1 ? neph_path_join(folder, "frame.exr") : frame_path(folder, i);
        status = path ? neph_job_render(job, &frame, &cost, diag) : neph_fail_memory(diag);
        if (!status)
            status = neph_exr_write(path, frame, diag);
        if (!status && i >= FRAMES - FLIPBOOK)
            status = write_flip(work, frame, folder, i - (FRAMES - FLIPBOOK), diag);
        total->render_s += cost.render_s;
        total->wall_s += cost.wall_s;
        total->cpu_s += cost.cpu_s;
        total->peak_memory_bytes = cost.peak_memory_bytes;
        neph_image_destroy(frame);
        free(path);
    }
    neph_job_close(job);
    return status;
}

static enum neph_status list_frames(const char *folder, struct neph_sequence *frames,
                                    struct neph_diag *diag)
{
    frames->paths = calloc(FRAMES, sizeof(*frames->paths));
    if (!frames->paths)
        return neph_fail_memory(diag);
    for (; frames->count < FRAMES; frames->count++) {
        char *path = frames->count == FRAMES - 1 ? neph_path_join(folder, "frame.exr")
                                                 : frame_path(folder, frames->count);
        if (!path)
            return neph_fail_memory(diag);
        frames->paths[frames->count] = path;
    }
    return NEPH_OK;
}

/* The flicker of the frames in `folder` into its flicker.json, with the maps. */
static enum neph_status measure(const struct work *work, const char *folder, struct neph_diag *diag)
{
    static const char extractor_name[] = "flicker";
    const struct neph_extractor *extractor = neph_extractor_find(extractor_name);
    struct neph_comparison comparison = {
        .choices = {{extractor, neph_options_default(extractor->options)}},
        .choice_count = 1,
        .viewing = NEPH_VIEWING_DEFAULTS,
        .detail_masks = true,
        .maps_directory = folder,
        .quiet = true};
    comparison.viewing.exposure_ev = work->scene->exposure_ev;
    comparison.viewing.frame_rate_hz = work->scene->frame_rate_hz;
    json_t *document = NULL;
    char *text = NULL, *path = neph_path_join(folder, "flicker.json");
    enum neph_status status = path ? list_frames(folder, &comparison.test, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_sequence_find(1, (const char *const *)&work->reference_path,
                                    &comparison.reference, diag);
    if (!status)
        status = neph_comparison_run(&comparison, &document, NULL, diag);
    if (!status && !(text = json_dumps(document, JSON_INDENT(1))))
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    free(path);
    json_decref(document);
    neph_comparison_finish(&comparison);
    return status;
}

/* ---- the store ------------------------------------------------------------------------------- */

/* Of the whole sequence with what is measured of it. */
static enum neph_status make_key(const struct neph_job *job, const char *reference_key,
                                 char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    char first[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_job_key(job, first, diag);
    if (status)
        return status;
    char *text = neph_format("neph-sequence-1\nframe 0 %s\nframes %d\nreference %s\nmeasured %d\n",
                             first, FRAMES, reference_key, MEASURED_REVISION);
    status = text ? neph_hash(text, strlen(text), key, diag) : neph_fail_memory(diag);
    free(text);
    return status;
}

/* What of the pictures the store keeps. */
static json_t *picture_names(void)
{
    json_t *names = json_pack("[s]", "a4_radiance.png");
    for (int i = 0; i < FLIPBOOK; i++)
        neph_json_add(&names, json_sprintf("flip_%d.png", i));
    return names;
}

/* Render and measure into a scratch folder, and publish the last frame and what was measured. */
static enum neph_status make_entry(const struct work *work, struct neph_job *job, const char *key,
                                   struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    char *kept = NULL;
    struct neph_cost cost = {0};
    json_t *record = NULL;
    enum neph_status status = neph_store_begin(work->store, &scratch, diag);
    if (status)
        return status;
    status = render_frames(work, job, neph_scratch_path(scratch), &cost, diag);
    if (!status)
        status = measure(work, neph_scratch_path(scratch), diag);
    if (!status && !(record = json_pack("{s:s, s:s, s:s, s:s, s:i, s:f, s:f, s:f, s:o}", "format",
                                        "neph-sequence-1", "scene", work->scene->name, "engine",
                                        job->engine->name, "version", job->info->version, "frames",
                                        FRAMES, "render_s", cost.render_s, "wall_s", cost.wall_s,
                                        "cpu_s", cost.cpu_s, "pictures", picture_names())))
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_store_publish(work->store, key, scratch, record, diag);
    else
        neph_store_abandon(work->store, key, scratch, &kept);
    json_decref(record);
    free(kept);
    neph_scratch_destroy(scratch);
    return status;
}

/* ---- rows of the report ---------------------------------------------------------------------- */

/* What the report shows of the numbers of all frames. */
static json_t *shown_measurements(const json_t *document)
{
    static const char *const metrics[] = {"visible_flicker_p95", "a4_p95", "std_p95"};
    static const char *const masks[] = {"all", "depth_edge", "non_edge"};
    const json_t *all = json_object_get(document, "measurements");
    json_t *shown = json_array();
    for (size_t m = 0; m < sizeof(masks) / sizeof(masks[0]); m++)
        for (size_t k = 0; k < sizeof(metrics) / sizeof(metrics[0]); k++) {
            const json_t *found = neph_measurement_find(all, "radiance", metrics[k], masks[m]);
            if (found)
                neph_json_add(&shown, json_incref((json_t *)found));
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
                        const json_t *record, const json_t *document)
{
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    json_t *row = json_pack("{s:s, s:s, s:s, s:s, s:s?, s:O, s:s, s:o, s:o, s:[], s:n}", "engine",
                            job->engine->name, "preset", preset, "status", "rendered", "reason", "",
                            "settings", settings, "render_s", json_object_get(record, "render_s"),
                            "folder", folder, "measurements", shown_measurements(document),
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

/* The row of an entry of the store. */
static enum neph_status read_entry(const char *preset, const struct neph_job *job,
                                   const char *last_frame, const json_t *record, json_t **row,
                                   struct neph_diag *diag)
{
    char *folder = strndup(last_frame, (size_t)(strrchr(last_frame, '/') - last_frame));
    char *path = folder ? neph_path_join(folder, "flicker.json") : NULL;
    json_error_t error;
    json_t *document = path ? json_load_file(path, 0, &error) : NULL;
    enum neph_status status = NEPH_OK;
    if (!path)
        status = neph_fail_memory(diag);
    else if (!document)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path, error.text);
    else if (!(*row = row_json(preset, job, folder, record, document)))
        status = neph_fail_memory(diag);
    json_decref(document);
    free(path);
    free(folder);
    return status;
}

static enum neph_status run_preset(const struct work *work, const char *preset,
                                   const char *reference_key, json_t **row, struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    char key[NEPH_HASH_HEX_SIZE], *last_frame = NULL;
    json_t *record = NULL;
    enum neph_status status = make_job(work, "realtime", &info, preset, &job, diag);
    if (!status)
        status = make_key(&job, reference_key, key, diag);
    if (!status && !neph_store_find(work->store, key, &last_frame, &record)) {
        status = make_entry(work, &job, key, diag);
        if (!status && !neph_store_find(work->store, key, &last_frame, &record))
            status = neph_fail(diag, NEPH_ERR_IO, "sequence %s is not readable after publishing",
                               key);
    }
    if (!status)
        status = read_entry(preset, &job, last_frame, record, row, diag);
    json_decref(record);
    free(last_frame);
    return status;
}

/* A step of progress that is one preset; what an engine cannot becomes a row too. */
static enum neph_status add_preset(const struct work *work, const char *preset,
                                   const char *reference_key, json_t *rows, struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    json_t *row = NULL;
    enum neph_status status = run_preset(work, preset, reference_key, &row, &why);
    const char *refusal = status == NEPH_ERR_UNAVAILABLE   ? "missing"
                          : status == NEPH_ERR_UNSUPPORTED ? "cannot"
                          : status == NEPH_ERR_ENGINE      ? "failed"
                                                           : NULL;
    if (refusal) {
        struct neph_engine_info info;
        struct neph_job job;
        status = make_job(work, "realtime", &info, preset, &job, diag);
        row = status ? NULL : refusal_json(preset, &job, refusal, why.message);
    } else if (status && diag) {
        *diag = why;
    }
    if (!status && json_array_append_new(rows, row) != 0)
        status = neph_fail_memory(diag);
    return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

static json_t *sequence_json(const struct work *work, const struct neph_job_result *reference)
{
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:f, s:{s:s, s:s, s:s, s:s}, s:[]}",
                     "scene", work->scene->name, "title", work->scene->title, "physics",
                     work->scene->physics, "size_px", width_px, height_px, "frames", FRAMES,
                     "rate_hz", work->scene->frame_rate_hz, "exposure_ev", work->scene->exposure_ev,
                     "reference", "engine", "march", "settings", reference->settings, "status",
                     neph_outcome_name(reference->outcome), "reason", reference->reason, "rows");
}

static enum neph_status run_presets(struct work *work, const char *reference_key, json_t *rows,
                                    struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < PRESETS && !status; i++) {
        char what[128];
        snprintf(what, sizeof(what), "%d frames of %s with realtime, preset %s", FRAMES, scene_name,
                 presets[i]);
        neph_progress_begin(work->progress, what);
        const double start_s = neph_wall_s();
        status = add_preset(work, presets[i], reference_key, rows, diag);
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
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    char key[NEPH_HASH_HEX_SIZE];
    const double start_s = neph_wall_s();
    char what[128];
    snprintf(what, sizeof(what), "reference of %s with march", scene_name);
    neph_progress_begin(work->progress, what);
    enum neph_status status = make_job(work, "march", &info, NULL, &job, diag);
    if (!status)
        status = neph_job_key(&job, key, diag);
    if (!status)
        status = neph_job_run(&job, work->store, &result, diag);
    if (!status)
        neph_progress_step(work->progress, what, neph_outcome_name(result.outcome),
                           neph_wall_s() - start_s);
    json_t *sequence = status ? NULL : sequence_json(work, &result);
    if (!status && json_array_append_new(list, sequence) != 0)
        status = neph_fail_memory(diag);
    work->reference_path = result.frame_path;
    if (!status && result.frame_path)
        status = run_presets(work, key, json_object_get(sequence, "rows"), diag);
    neph_job_result_finish(&result);
    return status;
}

enum neph_status neph_over_time_run(struct neph_store *store, struct neph_progress *progress,
                                    json_t *list, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(scene_name, &scene, diag);
    struct work work = {.scene = scene, .store = store, .progress = progress};
    if (!status)
        status = run_sequence(&work, list, diag);
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
    for (int i = 0; i < FLIPBOOK && entry && !status; i++) {
        char file[32], name[16];
        snprintf(file, sizeof(file), "flip_%d.png", i);
        snprintf(name, sizeof(name), "%d", i);
        json_t *path = NULL;
        status = copy_picture(entry, file, report_folder, scene, preset, name, &path, diag);
        if (!status && json_array_append_new(pictures, path) != 0)
            status = neph_fail_memory(diag);
    }
    if (!status && entry)
        status = copy_picture(entry, "a4_radiance.png", report_folder, scene, preset, "a4", &map,
                              diag);
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

/* SPDX-License-Identifier: MIT */
#include "harness/report/over_time.h"
#include "harness/engines/engines.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/compare/measure.h"
#include "harness/data.h"
#include "harness/report/flicker_map.h"
#include "harness/report/page.h"
#include "harness/study/floor_plan.h"
#include "renderer/realtime/options.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 16, PRESETS = NEPH_OVER_TIME_PRESETS };

/* Clouds that drift behind bars, at a size at which a bar and a gap are two pixels wide: a hard
 * case for temporal reconstruction. */
static const char scene_name[] = "fence_drift";
static const int width_px = 320, height_px = 180;
static const double pixels_per_degree = 60.0; /* as in `neph flicker` */
static const double timed_s = 2.0;            /* total duration of the frames that time a preset */

/* Common setting of the ray marcher and the real-time presets. The flicker measures the
 * reconstruction, which does not need all steps; an eighth of them leaves time for more frames and
 * reference rays. */
enum { STEPS = 8 };
static const char shared_setting[] = "steps=8";

/* Visible contrast in units of the threshold. */
static const char map_file[] = "flicker_seen_contrast.exr";

enum { METRICS = 3, MASKS = 3 };
static const char *const metrics[METRICS + 1] = {"seen_contrast", "seen_share", "std_p95", NULL};
static const char *const masks[MASKS] = {"all", "depth_edge", "non_edge"};

const char *const *neph_over_time_metrics(void)
{
    return metrics;
}

int neph_over_time_step_count(bool with_floors)
{
    int count = 0;
    while (count < PRESETS && neph_preset_find_by_use(neph_rt_presets, NEPH_RT_REPORT, count))
        count++;
    return 1 + count + with_floors;
}

struct work {
    const struct neph_scene *scene;
    struct neph_shared_device *device;
    struct neph_store *store;
    struct neph_times *times;
    struct neph_progress *progress;
    struct neph_reference reference;
    struct neph_arena *arena;
    struct neph_over_time *made;
    bool with_floors;
};

/* Make a job of a preset or floor; `preset` NULL: default settings, for the reference. */
static enum neph_status make_job(const struct work *work, struct neph_engine_info *info,
                                 const char *preset, struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find("realtime");
    neph_engine_probe(engine, work->device, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = work->scene,
                                      .settings = neph_settings_default(engine),
                                      .width_px = width_px,
                                      .height_px = height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = 1,
                                      .device = work->device}};
    return preset ? neph_engine_parse_words(preset, shared_setting, &job->engine,
                                            &job->shot.settings, diag)
                  : neph_settings_set(engine, &job->shot.settings, shared_setting, diag);
}

/* ---- one preset ------------------------------------------------------------------------------ */

static const char *const extractors[] = {"seen", "flicker", NULL};

static struct neph_viewing make_viewing(const struct neph_scene *scene)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = neph_scene_display(scene)->exposure_ev;
    viewing.frame_rate_hz = scene->frame_rate_hz;
    viewing.pixels_per_degree = pixels_per_degree;
    return viewing;
}

/* Measure flicker against the averaged reference, with its map, and against a reference of centre
 * rays. */
static enum neph_status take_preset(const struct work *work, const struct neph_job *job,
                                    char **folder, json_t **record, struct neph_diag *diag)
{
    const struct neph_viewing viewing = make_viewing(work->scene);
    const struct neph_measurement_set readings[] = {
        {"flicker", NEPH_REFERENCE_AVERAGED, extractors, .viewing = viewing,
         .map = "seen_contrast"},
        {"flicker_centre", NEPH_REFERENCE_CENTRE, extractors, .viewing = viewing},
    };
    const struct neph_capture take = {
        .job = *job,
        .frame_count = FRAMES,
        .reference = &work->reference,
        .readings = readings,
        .reading_count = sizeof(readings) / sizeof(readings[0]),
        .with_pictures = true,
        .all_masks = true,
    };
    return neph_capture_run(&take, work->store, folder, record, diag);
}

/* ---- rows of the report ---------------------------------------------------------------------- */

static bool has_json_text(const json_t *item, const char *key, const char *text)
{
    return strcmp(neph_json_text(item, key), text) == 0;
}

/* A measurement of all frames, with its value against centre rays. */
static json_t *shown_number(const json_t *found, const json_t *beside)
{
    json_t *number = json_copy((json_t *)found);
    const json_t *value = json_object_get(beside, "value");
    neph_json_set(&number, "against_centre_rays",
                  value ? json_incref((json_t *)value) : json_null());
    return number;
}

/* The measurements that the report shows. */
static json_t *shown_measurements(const json_t *document, const json_t *centre)
{
    json_t *shown = json_array();
    for (int m = 0; m < MASKS; m++)
        for (int k = 0; metrics[k]; k++) {
            const json_t *found = neph_capture_find_value(document, metrics[k], masks[m]);
            if (found)
                neph_json_add(&shown, shown_number(found, neph_capture_find_value(
                                                              centre, metrics[k], masks[m])));
        }
    return shown;
}

/* The findings that the report shows: flicker of the whole frame and of its depth edges. */
static json_t *shown_findings(const json_t *document)
{
    const json_t *all = json_object_get(document, "findings");
    json_t *shown = json_array();
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *item = json_array_get(all, i);
        if (has_json_text(item, "quantity", "radiance") &&
            has_json_text(item, "finding", "flicker") &&
            (has_json_text(item, "mask", "all") || has_json_text(item, "mask", "depth_edge")))
            neph_json_add(&shown, json_incref((json_t *)item));
    }
    return shown;
}

/* True for an error that only concerns the engine; the run continues, and `*outcome` is set. */
static bool is_missing_engine(enum neph_status status, enum neph_outcome *outcome)
{
    static const struct {
        enum neph_status status;
        enum neph_outcome outcome;
    } news[] = {
        {NEPH_ERR_UNAVAILABLE, NEPH_OUTCOME_MISSING},
        {NEPH_ERR_UNSUPPORTED, NEPH_OUTCOME_CANNOT},
        {NEPH_ERR_ENGINE, NEPH_OUTCOME_FAILED},
    };
    for (size_t i = 0; i < sizeof(news) / sizeof(news[0]); i++)
        if (news[i].status == status) {
            *outcome = news[i].outcome;
            return true;
        }
    return false;
}

static enum neph_status fill_row(const struct work *work, const struct neph_job *job,
                                 struct neph_over_time_row *row, struct neph_diag *diag)
{
    char *folder = NULL;
    json_t *record = NULL, *document = NULL, *centre = NULL;
    enum neph_status status = take_preset(work, job, &folder, &record, diag);
    if (!status)
        status = neph_capture_document(folder, "flicker", &document, diag);
    if (!status)
        status = neph_capture_document(folder, "flicker_centre", &centre, diag);
    if (!status) {
        row->render_s = json_number_value(json_object_get(record, "render_s"));
        row->folder = neph_arena_copy_text(work->arena, folder);
        row->measurements = shown_measurements(document, centre);
        row->findings = shown_findings(document);
    }
    json_decref(document);
    json_decref(centre);
    json_decref(record);
    free(folder);
    return status;
}

/* Run a preset. An engine's failure becomes a row as well. */
static enum neph_status add_preset(const struct work *work, const char *preset,
                                   struct neph_over_time_row *row, struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    struct neph_diag why = {.line = 0};
    enum neph_status status = make_job(work, &info, preset, &job, &why);
    char *settings = neph_settings_text(job.engine, &job.shot.settings);
    *row = (struct neph_over_time_row){.preset = preset,
                                       .outcome = NEPH_OUTCOME_RENDERED,
                                       .reason = "",
                                       .settings = neph_arena_copy_text(work->arena, settings)};
    free(settings);
    if (!status)
        status = fill_row(work, &job, row, &why);
    if (!status && work->times)
        status = neph_speed_measure(&job, NULL, 0, timed_s, work->store, work->times, &row->speed,
                                    &why);
    work->made->row_count++;
    if (is_missing_engine(status, &row->outcome)) {
        row->reason = neph_arena_copy_text(work->arena, why.message);
        return NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    return status;
}

/* ---- floors ---------------------------------------------------------------------------------- */

/* The document of a configuration of the plan, which has the shown metrics; NULL: none. */
static enum neph_status measure_floor(const struct work *work, const char *words, json_t **document,
                                      struct neph_diag *diag)
{
    struct neph_meter_number kept[METRICS * MASKS + 1] = {{NULL, NULL}};
    struct neph_engine_info info;
    char *folder = NULL;
    json_t *record = NULL;
    for (int i = 0; i < METRICS * MASKS; i++)
        kept[i] = (struct neph_meter_number){metrics[i % METRICS], masks[i / METRICS]};
    const struct neph_measurement_set reading = {"floor", NEPH_REFERENCE_AVERAGED, extractors,
                                                 .viewing = make_viewing(work->scene),
                                                 .kept = kept};
    struct neph_capture take = {.frame_count = FRAMES,
                                .reference = &work->reference,
                                .readings = &reading,
                                .reading_count = 1,
                                .plain = true};
    enum neph_status status = make_job(work, &info, words, &take.job, diag);
    if (!status)
        status = neph_capture_run(&take, work->store, &folder, &record, diag);
    if (!status)
        status = neph_capture_document(folder, reading.name, document, diag);
    json_decref(record);
    free(folder);
    return status;
}

json_t *neph_over_time_add_floor(const json_t *found,
                                 const json_t *const documents[NEPH_STUDY_FLOOR_CANDIDATES])
{
    double lower = INFINITY;
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES; i++) {
        const double floor = neph_json_real(neph_capture_find_value(documents[i],
                                                                    neph_json_text(found, "metric"),
                                                                    neph_json_text(found, "mask")),
                                            "value");
        lower = isnan(floor) ? NAN : fmin(lower, floor);
        if (isnan(lower))
            break;
    }
    json_t *number = json_copy((json_t *)found);
    neph_json_set(&number, "floor", neph_json_number(lower));
    neph_json_set(&number, "times_floor",
                  neph_json_number(lower > 0.0 ? neph_json_real(found, "value") / lower : NAN));
    return number;
}

static void add_row_floors(struct neph_over_time_row *row,
                           const json_t *const documents[NEPH_STUDY_FLOOR_CANDIDATES])
{
    json_t *with_floors = json_array();
    for (size_t i = 0; i < json_array_size(row->measurements); i++)
        neph_json_add(&with_floors,
                      neph_over_time_add_floor(json_array_get(row->measurements, i), documents));
    json_decref(row->measurements);
    row->measurements = with_floors;
}

/* Measure the floors of a row that other rows have not measured yet. A failure of the engine leaves
 * numbers without floors. */
static enum neph_status measure_row_floors(const struct work *work,
                                           const struct neph_floor_plan *plan, int row,
                                           json_t **documents, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES && !status; i++) {
        const int floor = plan->floors[row].candidates[i];
        struct neph_diag why = {.line = 0};
        enum neph_outcome outcome;
        if (!documents[floor])
            status = measure_floor(work, plan->words[floor], &documents[floor], &why);
        if (is_missing_engine(status, &outcome))
            status = NEPH_OK;
        if (status && diag)
            *diag = why;
    }
    return status;
}

static enum neph_status add_floors(const struct work *work, struct neph_diag *diag)
{
    struct neph_over_time *made = work->made;
    struct neph_floor_plan plan;
    const char *presets[PRESETS];
    json_t *documents[(1 + NEPH_STUDY_FLOOR_CANDIDATES) * PRESETS] = {NULL};
    for (int i = 0; i < made->row_count; i++)
        presets[i] = made->rows[i].preset;
    enum neph_status status = neph_floor_plan_make(presets, made->row_count, STEPS, work->arena,
                                                   &plan, diag);
    for (int i = 0; i < made->row_count && !status; i++) {
        const int *candidates = plan.floors[i].candidates;
        if (!made->rows[i].measurements)
            continue;
        status = measure_row_floors(work, &plan, i, documents, diag);
        if (!status)
            add_row_floors(&made->rows[i], (const json_t *const[]){documents[candidates[0]],
                                                                   documents[candidates[1]]});
        made->rows[i].floors[0] = plan.words[candidates[0]];
        made->rows[i].floors[1] = plan.words[candidates[1]];
    }
    for (size_t i = 0; i < sizeof(documents) / sizeof(documents[0]); i++)
        json_decref(documents[i]);
    return status;
}

static enum neph_status run_floors(const struct work *work, struct neph_diag *diag)
{
    char what[128];
    const double start_s = neph_wall_s();
    snprintf(what, sizeof(what), "floors of %s", scene_name);
    neph_progress_begin(work->progress, what);
    const enum neph_status status = add_floors(work, diag);
    neph_progress_step(work->progress, what, status ? "" : "measured", neph_wall_s() - start_s);
    return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

static enum neph_status run_presets(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const struct neph_preset *preset;
    for (int i = 0; i < PRESETS && !status &&
                    (preset = neph_preset_find_by_use(neph_rt_presets, NEPH_RT_REPORT, i));
         i++) {
        struct neph_over_time_row *row = &work->made->rows[i];
        char what[128];
        snprintf(what, sizeof(what), "%d frames of %s with realtime, preset %s", FRAMES, scene_name,
                 preset->name);
        neph_progress_begin(work->progress, what);
        const double start_s = neph_wall_s();
        status = add_preset(work, preset->name, row, diag);
        neph_progress_step(work->progress, what, status ? "" : neph_outcome_name(row->outcome),
                           neph_wall_s() - start_s);
    }
    return status;
}

/* Fill the texts about the scene and its reference. */
static void describe(struct work *work, const char *reason)
{
    const struct neph_reference *reference = &work->reference;
    struct neph_over_time *made = work->made;
    const bool is_there = reference->text != NULL;
    made->scene = neph_arena_copy_text(work->arena, work->scene->name);
    made->title = neph_arena_copy_text(work->arena, work->scene->title);
    made->physics = neph_arena_copy_text(work->arena, work->scene->description);
    made->width_px = width_px;
    made->height_px = height_px;
    made->frame_count = FRAMES;
    made->rate_hz = work->scene->frame_rate_hz;
    made->exposure_ev = neph_scene_display(work->scene)->exposure_ev;
    made->reference.reason = neph_arena_copy_text(work->arena, reason);
    made->reference.settings = neph_arena_copy_text(work->arena,
                                                    is_there ? reference->settings : "");
    made->reference.text = neph_arena_copy_text(work->arena, is_there ? reference->text
                                                                      : "march, 16 rays a pixel");
    made->reference.cpu_s = is_there ? reference->cost.cpu_s : NAN;
}

/* Run the sequence. Without a reference it contains the reason and no rows. */
static enum neph_status run_sequence(struct work *work, struct neph_over_time **made,
                                     struct neph_diag *diag)
{
    struct neph_engine_info info;
    struct neph_job job;
    struct neph_progress unseen = neph_progress_start(true, 0); /* the reference is a single step
                                                                   here */
    struct neph_diag why = {.line = 0};
    enum neph_outcome outcome = NEPH_OUTCOME_RENDERED;
    const double start_s = neph_wall_s();
    char what[128];
    snprintf(what, sizeof(what), "reference of %s with march", scene_name);
    neph_progress_begin(work->progress, what);
    const enum neph_status made_job = make_job(work, &info, NULL, &job, &why);
    const enum neph_status status = made_job ? made_job
                                             : neph_reference_make(&job, FRAMES, work->store,
                                                                   &unseen, &work->reference, &why);
    if (status && !is_missing_engine(status, &outcome)) {
        if (diag)
            *diag = why;
        return status;
    }
    neph_progress_step(work->progress, what, neph_outcome_name(outcome), neph_wall_s() - start_s);
    work->made = neph_arena_allocate(work->arena, 1, sizeof(*work->made));
    if (!work->made)
        return neph_fail_memory(diag);
    work->made->reference.outcome = outcome;
    describe(work, why.message);
    *made = work->made;
    if (status)
        return NEPH_OK;
    const enum neph_status ran = run_presets(work, diag);
    return ran || !work->with_floors ? ran : run_floors(work, diag);
}

enum neph_status neph_over_time_run(struct neph_shared_device *device, struct neph_store *store,
                                    struct neph_times *times, bool with_floors,
                                    struct neph_progress *progress, struct neph_arena *arena,
                                    struct neph_over_time **made, struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(scene_name, &scene, diag);
    struct work work = {.scene = scene,
                        .device = device,
                        .store = store,
                        .times = times,
                        .progress = progress,
                        .arena = arena,
                        .with_floors = with_floors};
    if (!status)
        status = run_sequence(&work, made, diag);
    neph_reference_finish(&work.reference);
    neph_scene_destroy(scene);
    return status ? status : neph_arena_check(arena, diag);
}

void neph_over_time_finish(struct neph_over_time *over_time)
{
    for (int i = 0; over_time && i < over_time->row_count; i++) {
        json_decref(over_time->rows[i].measurements);
        json_decref(over_time->rows[i].findings);
    }
}

bool neph_over_time_passes(const struct neph_over_time *over_time)
{
    bool pass = !over_time || !neph_outcome_is_broken(over_time->reference.outcome);
    for (int i = 0; over_time && i < over_time->row_count; i++)
        pass = pass && !neph_outcome_is_broken(over_time->rows[i].outcome);
    return pass;
}

/* ---- images of the report -------------------------------------------------------------------- */

static enum neph_status copy_row(struct neph_over_time_row *row, const char *scene,
                                 const char *report_folder, struct neph_arena *arena,
                                 struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (!row->folder || row->map)
        return NEPH_OK;
    for (int i = 0; i < NEPH_CAPTURE_IMAGES && !status; i++) {
        char file[32];
        snprintf(file, sizeof(file), "flip_%d.png", i);
        row->pictures[i] = neph_arena_format(arena, "images/over_time/%s_%s_%d.png", scene,
                                             row->preset, i);
        status = neph_page_copy(row->folder, file, report_folder, row->pictures[i], diag);
    }
    row->map = neph_arena_format(arena, "images/over_time/%s_%s_seen.png", scene, row->preset);
    return status ? status
                  : neph_flicker_map_draw(neph_path_in(row->folder, map_file).text,
                                          neph_path_in(report_folder, row->map).text, diag);
}

enum neph_status neph_over_time_images(struct neph_over_time *over_time, const char *report_folder,
                                       struct neph_arena *arena, struct neph_diag *diag)
{
    if (!over_time)
        return NEPH_OK;
    enum neph_status status = neph_dir_create(neph_path_in(report_folder, "images/over_time").text,
                                              diag);
    for (int i = 0; i < over_time->row_count && !status; i++)
        status = copy_row(&over_time->rows[i], over_time->scene, report_folder, arena, diag);
    return status ? status : neph_arena_check(arena, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *list_or_empty(json_t *list)
{
    return list ? json_incref(list) : json_array();
}

static json_t *row_json(const struct neph_over_time_row *row)
{
    json_t *pictures = json_array();
    for (int i = 0; i < NEPH_CAPTURE_IMAGES && row->pictures[i]; i++)
        neph_json_add(&pictures, json_string(row->pictures[i]));
    json_t *floors = row->floors[0] ? json_pack("[s,s]", row->floors[0], row->floors[1])
                                    : json_array();
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:o, s:o, s:s?, s:o, s:o, s:o, s:s?, s:o}", "engine",
        "realtime", "preset", row->preset, "status", neph_outcome_name(row->outcome), "reason",
        row->reason, "settings", row->settings, "floors", floors, "render_s",
        row->folder ? json_real(row->render_s) : json_null(), "folder", row->folder, "measurements",
        list_or_empty(row->measurements), "findings", list_or_empty(row->findings), "pictures",
        pictures, "map", row->map, "speed", neph_speed_json(&row->speed));
}

json_t *neph_over_time_json(const struct neph_over_time *over_time)
{
    json_t *rows = json_array();
    for (int i = 0; i < over_time->row_count; i++)
        neph_json_add(&rows, row_json(&over_time->rows[i]));
    return json_pack(
        "{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:f, "
        "s:{s:s, s:s, s:s, s:s, s:s, s:o}, s:o, s:o}",
        "scene", over_time->scene, "title", over_time->title, "physics", over_time->physics,
        "size_px", over_time->width_px, over_time->height_px, "frames", over_time->frame_count,
        "rate_hz", over_time->rate_hz, "exposure_ev", over_time->exposure_ev, "reference", "engine",
        "march", "settings", over_time->reference.settings, "text", over_time->reference.text,
        "status", neph_outcome_name(over_time->reference.outcome), "reason",
        over_time->reference.reason, "cpu_s", neph_json_number(over_time->reference.cpu_s),
        "map_scale", neph_flicker_map_scale_json(), "rows", rows);
}

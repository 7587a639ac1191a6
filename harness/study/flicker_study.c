/* SPDX-License-Identifier: MIT
 *
 * The flicker study: jobs, captured sequences, measurements, judgement of each value.
 */
#include "harness/study/flicker_study.h"

#include "base/clock.h"
#include "base/files.h"
#include "harness/compare/measure.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/run/seed.h"
#include "harness/study/ideal.h"
#include "harness/study/take.h"
#include "metrics/extractors/flicker_verdict.h"
#include "scenes/display.h"
#include "scenes/frame_rate.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the sequences of this file depend on the variants, and
 * its measurement sets on the references. */
_Static_assert(NEPH_VARIANT_KIND_COUNT == 3, "a new kind");
_Static_assert(NEPH_IDEALS == 3, "a new kind");

enum { KIND_REFERENCE, KIND_TAKE }; /* of progress steps */

/* Expected seconds before the first step has finished, on two cores. */
static const double reference_typical_s = 10.0, take_typical_s = 30.0;

/* One sequence of the study. */
struct study_cell_id {
    int scene;
    enum neph_study_capture_id take;
    int preset, seed;
};

struct work {
    const struct neph_flicker_study_params *params;
    struct neph_flicker_study *study;
    struct neph_store *store;
    struct neph_progress progress;
    struct neph_engine_info info,
        user_engine_info;            /* of `realtime`, and of the user engine where a preset
                                            names it */
    struct neph_reference reference; /* of the current sequence */
    struct neph_ideal ideal;         /* of the current scene and seed */
};

/* Presets and floors. */
static int count_configurations(const struct neph_flicker_study_params *params)
{
    return params->preset_count + params->floor_count;
}

static int compute_row_index(const struct neph_flicker_study_params *params, int scene, int preset,
                             int seed)
{
    return (scene * count_configurations(params) + preset) * params->seed_count + seed;
}

struct neph_study_cell *neph_study_cell_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed, int metric)
{
    const int row = compute_row_index(study->params, scene, preset, seed);
    return &study->cells[row * neph_study_metric_count() + metric];
}

struct neph_study_cost *neph_study_cost_at(const struct neph_flicker_study *study, int scene,
                                           int preset, int seed)
{
    return &study->costs[compute_row_index(study->params, scene, preset, seed)];
}

/* ---- jobs ------------------------------------------------------------------------------------ */

static enum neph_status make_job(const struct work *work, const struct neph_scene *scene,
                                 const char *words, int seed, struct neph_job *job,
                                 struct neph_diag *diag)
{
    const struct neph_flicker_study_params *params = work->params;
    *job = (struct neph_job){.shot = {.scene = scene,
                                      .width_px = params->width_px,
                                      .height_px = params->height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .time_limit_s = NEPH_USER_ENGINE_LIMIT_S,
                                      .device = params->device,
                                      .seed = scene ? neph_seed_for_scene(scene, seed) : 1}};
    char steps[32];
    snprintf(steps, sizeof(steps), "steps=%d", params->steps);
    const enum neph_status status = neph_engine_parse_words(words, steps, &job->engine,
                                                            &job->shot.settings, diag);
    if (!status && scene)
        neph_settings_adapt_to_scene(job->engine, scene, &job->shot.settings);
    if (!status)
        job->info = job->engine->is_user_engine ? &work->user_engine_info : &work->info;
    return status;
}

/* ---- measurement sets ------------------------------------------------------------------------ */

enum {
    READINGS_MAX = 1 + NEPH_IDEALS + NEPH_STUDY_DISPLAYS,
    KEPT_MAX = 4 * NEPH_STUDY_METRICS_MAX + 1,
};

static struct neph_viewing make_display_viewing(const struct neph_scene *scene,
                                                const struct neph_flicker_study_params *params,
                                                int index)
{
    const struct neph_study_display display = neph_study_display_at(params->frame_rate_hz, index);
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = neph_scene_display(scene)->exposure_ev;
    viewing.frame_rate_hz = display.frame_rate_hz;
    viewing.pixels_per_degree = display.pixels_per_degree;
    return viewing;
}

static const char *const display_names[NEPH_STUDY_DISPLAYS] = {
    "averaged", "display_1", "display_2", "display_3", "display_4", "display_5"};

static const char centre_name[] = "centre", map_name[] = "seen_contrast";
static const char *const ideal_names[NEPH_IDEALS] = {
    [NEPH_IDEAL_SEQUENCE] = "ideal",
    [NEPH_IDEAL_BLURRED] = "blurred",
    [NEPH_IDEAL_ALIASED] = "aliased",
};

struct neph_path neph_study_map_path(const char *folder, enum neph_ideal_kind against)
{
    return neph_path_format("%s/%s_%s.exr", folder,
                            against == NEPH_IDEALS ? display_names[0] : ideal_names[against],
                            map_name);
}

static bool has_centre(const struct neph_flicker_study_params *params)
{
    return !params->ideal && !params->brief;
}

/* Lists the metrics of the tables for a sequence, with the metrics that decide whether they count.
 */
static void list_kept(enum neph_study_capture_id id, bool only_headline,
                      struct neph_meter_number kept[KEPT_MAX])
{
    int count = 0;
    const struct neph_study_metric *headline = &neph_study_metrics[neph_study_find_headline()];
    for (const struct neph_study_metric *metric = neph_study_metrics; metric->title; metric++) {
        if (only_headline && metric != headline)
            continue;
        const char *const names[] = {metric->metric, metric->alone, metric->never_share,
                                     metric->at_most};
        for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
            if (metric->take == id && names[i])
                kept[count++] = (struct neph_meter_number){names[i], metric->mask};
    }
    kept[count] = (struct neph_meter_number){.metric = NULL};
}

/* Adds the measurement sets against references made of the ideal. The sequence with all parts real
 * keeps their maps. */
static int list_ideal_sets(const struct work *work, const struct study_cell_id *id,
                           const struct neph_measurement_set *averaged,
                           struct neph_measurement_set *readings)
{
    int count = 0;
    for (; work->params->ideal && count < NEPH_IDEALS; count++) {
        readings[count] = *averaged;
        readings[count].name = ideal_names[count];
        readings[count].reference = &work->ideal.references[count];
        readings[count].map = id->preset == 0 ? averaged->map : NULL;
    }
    return count;
}

/* Lists the measurement sets of a sequence: all metrics against the averaged reference and the
 * others, and unless `brief` the eye's metrics for the other displays. */
static int list_measurement_sets(const struct work *work, const struct neph_scene *scene,
                                 const struct study_cell_id *id,
                                 const struct neph_meter_number *kept,
                                 struct neph_measurement_set readings[READINGS_MAX])
{
    const struct neph_study_capture *take = &neph_study_captures[id->take];
    const struct neph_viewing viewing = make_display_viewing(scene, work->params, 0);
    int count = 0;
    const struct neph_measurement_set averaged = {
        .name = display_names[0],
        .against = NEPH_REFERENCE_AVERAGED,
        .map = id->preset < work->params->map_count ? map_name : NULL,
        .extractors = work->params->ideal ? neph_study_eye_extractors : take->extractors,
        .settings = take->settings,
        .viewing = viewing,
        .kept = kept};
    readings[count++] = averaged;
    count += list_ideal_sets(work, id, &averaged, readings + count);
    readings[count] = averaged;
    readings[count].name = centre_name;
    readings[count].against = NEPH_REFERENCE_CENTRE;
    count += has_centre(work->params);
    const bool has_displays = id->take == NEPH_STUDY_FLICKER && !work->params->brief;
    const int display_count = has_displays ? neph_study_display_count(work->params->frame_rate_hz)
                                           : 1;
    for (int d = 1; d < display_count; d++)
        readings[count++] = (struct neph_measurement_set){
            .name = display_names[d],
            .against = NEPH_REFERENCE_AVERAGED,
            .extractors = neph_study_eye_extractors,
            .viewing = make_display_viewing(scene, work->params, d),
            .kept = kept};
    return count;
}

/* ---- values ---------------------------------------------------------------------------------- */

static double read_metric_value(const json_t *document, const char *metric, const char *mask)
{
    return neph_json_real(neph_capture_find_value(document, metric, mask), "value");
}

static void set_cell_reason(struct neph_study_cell *cell, const char *why)
{
    snprintf(cell->because, sizeof(cell->because), "%s", why);
}

/* Decides whether a value takes part in comparisons; `because` gets the reason if not. */
static void judge_cell(const struct neph_study_metric *metric, const json_t *document,
                       struct neph_study_cell *cell)
{
    const json_t *found = neph_capture_find_value(document, metric->metric, metric->mask);
    const double alone = metric->alone ? read_metric_value(document, metric->alone, metric->mask)
                                       : NAN;
    const double bound = metric->at_most
                             ? read_metric_value(document, metric->at_most, metric->mask)
                             : NAN;
    const double never = metric->never_share
                             ? read_metric_value(document, metric->never_share, metric->mask)
                             : NAN;
    if (found && isnan(cell->value) && !isnan(bound)) {
        cell->value = cell->displays[0] = bound;
        cell->is_bound = bound > 0.0; /* a bound of 0 is exact: all parts of a zero are zero */
    }
    if (!found)
        set_cell_reason(cell, "the scene has no such pixels");
    else if (isnan(cell->value))
        set_cell_reason(cell, neph_json_text(found, "undefined_because"));
    else if (alone > 0.0 && neph_flicker_reference_limited(cell->value, alone))
        set_cell_reason(cell, "reference-limited: the reference alone has more than a third of it");
    else if (never > NEPH_STUDY_NEVER_MOST)
        set_cell_reason(cell, "more than 5 % of the pixels never get there");
    else
        cell->counts = true;
    if (cell->counts)
        set_cell_reason(cell, "");
}

static struct neph_study_cell *cell_at(const struct work *work,
                                       const struct study_cell_id *study_cell_id, int metric)
{
    return neph_study_cell_at(work->study, study_cell_id->scene, study_cell_id->preset,
                              study_cell_id->seed, metric);
}

/* Reads the headline metric against references made of the ideal. */
static enum neph_status read_ideals(const struct work *work, const char *folder,
                                    const struct study_cell_id *study_cell_id,
                                    struct neph_diag *diag)
{
    const int headline = neph_study_find_headline();
    const struct neph_study_metric *metric = &neph_study_metrics[headline];
    struct neph_study_cell *cell = cell_at(work, study_cell_id, headline);
    enum neph_status status = NEPH_OK;
    for (int i = 0; work->params->ideal && i < NEPH_IDEALS && !status; i++) {
        json_t *document = NULL;
        status = neph_capture_document(folder, ideal_names[i], &document, diag);
        cell->ideals[i] = read_metric_value(document, metric->metric, metric->mask);
        json_decref(document);
    }
    return status;
}

static enum neph_status read_cells(const struct work *work, const char *folder,
                                   const struct study_cell_id *study_cell_id,
                                   struct neph_diag *diag)
{
    json_t *documents[NEPH_STUDY_DISPLAYS] = {NULL}, *centre = NULL;
    const bool is_flicker = study_cell_id->take == NEPH_STUDY_FLICKER;
    const int display_count = is_flicker && !work->params->brief
                                  ? neph_study_display_count(work->params->frame_rate_hz)
                                  : 1;
    enum neph_status status = read_ideals(work, folder, study_cell_id, diag);
    if (!status && has_centre(work->params))
        status = neph_capture_document(folder, centre_name, &centre, diag);
    for (int d = 0; d < display_count && !status; d++)
        status = neph_capture_document(folder, display_names[d], &documents[d], diag);
    for (int m = 0; neph_study_metrics[m].title && !status; m++) {
        const struct neph_study_metric *metric = &neph_study_metrics[m];
        struct neph_study_cell *cell = cell_at(work, study_cell_id, m);
        if (metric->take != study_cell_id->take)
            continue;
        cell->value = read_metric_value(documents[0], metric->metric, metric->mask);
        cell->centre = read_metric_value(centre, metric->metric, metric->mask);
        cell->displays[0] = cell->value;
        for (int d = 1; d < display_count && metric->of_the_eye; d++)
            cell->displays[d] = read_metric_value(documents[d], metric->metric, metric->mask);
        judge_cell(metric, documents[0], cell);
    }
    for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
        json_decref(documents[d]);
    json_decref(centre);
    return status;
}

/* Sets one reason for all metrics of a sequence. */
static void mark_cells(const struct work *work, const struct study_cell_id *study_cell_id,
                       const char *why)
{
    for (int m = 0; neph_study_metrics[m].title; m++)
        if (neph_study_metrics[m].take == study_cell_id->take)
            set_cell_reason(cell_at(work, study_cell_id, m), why);
}

static enum neph_status read_cost(const struct work *work, const char *folder, const json_t *record,
                                  const struct study_cell_id *study_cell_id, struct neph_diag *diag)
{
    const double pixels = neph_json_real(record, "frames") * (double)work->params->width_px *
                          work->params->height_px;
    struct neph_study_cost *cost = neph_study_cost_at(work->study, study_cell_id->scene,
                                                      study_cell_id->preset, study_cell_id->seed);
    *cost = (struct neph_study_cost){
        .blur_px = NAN,
        .folder = neph_arena_copy_text(&work->study->arena, folder),
        .density_evaluations = neph_json_real(record, "density_evaluations") / pixels,
        .traffic_bytes = neph_json_real(record, "traffic_bytes") / pixels,
        .gpu_ms = neph_json_real(record, "gpu_ms_median"),
    };
    return work->params->ideal ? neph_ideal_read_blur(folder, &cost->blur_px, diag) : NEPH_OK;
}

/* ---- one sequence ---------------------------------------------------------------------------- */

/* Gets the reference of a sequence. Presets with the same steps share it. The reference of a user
 * engine is the marcher at the study's settings. */
static enum neph_status ensure_reference(struct work *work, const struct neph_job *asked, int count,
                                         struct neph_study_scene *row, struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    struct neph_reference *reference = &work->reference;
    struct neph_job march;
    enum neph_status status = make_job(work, asked->shot.scene, "off", 1, &march, diag);
    const struct neph_job *job = asked->engine->is_user_engine ? &march : asked;
    if (!status)
        status = neph_reference_key(job, count, key, diag);
    if (status || (reference->text && strcmp(reference->key, key) == 0))
        return status;
    neph_reference_finish(reference);
    work->progress.kind = KIND_REFERENCE;
    status = neph_reference_make(job, count, work->store, &work->progress, reference, diag);
    if (status)
        return status;
    row->picture_count += reference->picture_count;
    row->reference_s += reference->cost.cpu_s;
    if (!row->reference)
        row->reference = neph_arena_copy_text(&work->study->arena, reference->text);
    return NEPH_OK;
}

/* Measures a sequence, or finds it in the store. The frames of the ideal sequence with its seed are
 * rendered for the first sequence that is not in the store. */
static enum neph_status measure_capture(struct work *work, const struct neph_job *ideal,
                                        const struct neph_capture *take, char **folder,
                                        json_t **record, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (work->params->ideal && !neph_capture_is_stored(take, work->store))
        status = neph_ideal_render(&work->ideal, ideal,
                                   &work->reference.frames[NEPH_REFERENCE_AVERAGED],
                                   take->frame_count, work->store, diag);
    return status ? status : neph_capture_run(take, work->store, folder, record, diag);
}

/* Chooses the ideal sequence of a test, if the study has one. */
static enum neph_status choose_ideal(struct work *work, const struct neph_job *test,
                                     struct neph_job *ideal, struct neph_diag *diag)
{
    if (!work->params->ideal)
        return NEPH_OK;
    enum neph_status status = make_job(work, test->shot.scene, work->params->ideal, 1, ideal, diag);
    ideal->shot.seed = test->shot.seed;
    return status ? status : neph_ideal_choose(&work->ideal, ideal, diag);
}

static int count_capture_frames(const struct neph_study_scene *row, enum neph_study_capture_id id)
{
    return neph_study_captures[id].frame_count ? neph_study_captures[id].frame_count
                                               : row->frame_count;
}

static enum neph_status run_capture(struct work *work, const struct neph_job *job,
                                    const struct study_cell_id *study_cell_id,
                                    struct neph_diag *diag)
{
    struct neph_study_scene *row = &work->study->scenes[study_cell_id->scene];
    struct neph_measurement_set readings[READINGS_MAX];
    struct neph_meter_number kept[KEPT_MAX];
    char *folder = NULL;
    json_t *record = NULL;
    struct neph_job ideal;
    struct neph_capture take = {
        .job = *job,
        .frame_count = count_capture_frames(row, study_cell_id->take),
        .reference = &work->reference,
        .readings = readings,
        .plain = true, /* the scenes are the sample: no intervals within one */
        .allow_frozen_frames = true,
        .look = work->params->ideal ? neph_ideal_keep_blur : NULL,
        .callback_context = &work->ideal};
    enum neph_status status = ensure_reference(work, job, take.frame_count, row, diag);
    if (!status)
        status = choose_ideal(work, job, &ideal, diag);
    if (status)
        return status;
    list_kept(study_cell_id->take, work->params->ideal != NULL, kept);
    take.reading_count = list_measurement_sets(work, job->shot.scene, study_cell_id, kept,
                                               readings);
    status = measure_capture(work, &ideal, &take, &folder, &record, diag);
    if (!status)
        status = read_cells(work, folder, study_cell_id, diag);
    if (!status)
        row->takes_s += json_number_value(json_object_get(record, "cpu_s"));
    if (!status && study_cell_id->take == NEPH_STUDY_FLICKER)
        status = read_cost(work, folder, record, study_cell_id, diag);
    json_decref(record);
    free(folder);
    return status;
}

/* Measures one sequence. A failure of one sequence is noted in its cells; an unsupported scene and
 * an interruption are returned. */
static enum neph_status try_capture(struct work *work, const struct neph_scene *scene,
                                    const struct study_cell_id *study_cell_id,
                                    struct neph_diag *diag)
{
    struct neph_job job;
    struct neph_diag why = {.line = 0};
    char what[256];
    const struct neph_flicker_study_params *params = work->params;
    snprintf(what, sizeof(what), "%s, %s, %s%s, seed %d",
             work->study->scenes[study_cell_id->scene].name,
             neph_study_captures[study_cell_id->take].name, params->labels ? "" : "preset ",
             (params->labels ? params->labels : params->presets)[study_cell_id->preset],
             params->seeds_before + study_cell_id->seed + 1);
    neph_progress_begin(&work->progress, what);
    enum neph_status status = make_job(work, scene, params->presets[study_cell_id->preset],
                                       params->seeds_before + study_cell_id->seed + 1, &job, &why);
    const double start_s = neph_wall_s();
    if (!status)
        status = run_capture(work, &job, study_cell_id, &why);
    work->progress.kind = KIND_TAKE;
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_GATE || status == NEPH_ERR_TIMEOUT) {
        work->study->failed_count++;
        neph_progress_warn("%s: %s", what, why.message);
        mark_cells(work, study_cell_id, why.message);
        status = NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    if (!status)
        neph_progress_step(&work->progress, what, "measured", neph_wall_s() - start_s);
    return status;
}

/* ---- one scene ------------------------------------------------------------------------------- */

/* Whether a preset or floor can render the scene; `why` is the reason if not. */
static bool can_render(const struct work *work, const struct neph_scene *scene, int preset,
                       char *why, size_t size)
{
    struct neph_job job;
    return make_job(work, scene, work->params->presets[preset], 1, &job, NULL) != NEPH_OK ||
           job.engine->can_render(scene, &job.shot.settings, why, size);
}

/* Measures one sequence, if there is no obstacle and, for a floor, if it can render the scene. */
static enum neph_status visit_capture(struct work *work, const struct neph_scene *scene,
                                      const struct study_cell_id *study_cell_id,
                                      const char *obstacle, struct neph_diag *diag)
{
    char why[512] = "";
    const bool is_floor = study_cell_id->preset >= work->params->preset_count;
    if (!obstacle && is_floor && !can_render(work, scene, study_cell_id->preset, why, sizeof(why)))
        obstacle = why;
    if (!obstacle)
        return try_capture(work, scene, study_cell_id, diag);
    mark_cells(work, study_cell_id, obstacle);
    return NEPH_OK;
}

/* Renders a sequence of a scene with all presets, floors and seeds, or only counts it for the
 * progress. */
static enum neph_status walk_capture(struct work *work, const struct neph_scene *scene, int index,
                                     enum neph_study_capture_id id, bool is_counted,
                                     struct neph_diag *diag)
{
    const struct neph_study_capture *take = &neph_study_captures[id];
    const bool is_scene = take->variant == NEPH_VARIANT_KIND_COUNT;
    const struct neph_variant change = {take->variant, NEPH_STUDY_EVENT_FRAME, take->frame_count};
    const char *obstacle = is_scene ? NULL : neph_variant_obstacle(scene, take->variant);
    const int configurations = count_configurations(work->params),
              count = configurations * work->params->seed_count;
    struct neph_scene *variant = NULL;
    enum neph_status status = NEPH_OK;
    if (!is_scene && !obstacle)
        status = neph_scene_variant(scene, &change, &variant, diag);
    const struct neph_scene *shown = variant ? variant : scene;
    if (is_counted && !obstacle && !status) {
        const int frame_count = count_capture_frames(&work->study->scenes[index], id);
        neph_progress_expect(&work->progress, KIND_REFERENCE,
                             neph_reference_frame_count(shown, 0, frame_count),
                             reference_typical_s);
        neph_progress_expect(&work->progress, KIND_TAKE, count, take_typical_s);
    }
    for (int i = 0; i < count && !is_counted && !status; i++) {
        const struct study_cell_id study_cell_id = {index, id, i % configurations,
                                                    i / configurations};
        status = visit_capture(work, shown, &study_cell_id, obstacle, diag);
    }
    neph_scene_destroy(variant);
    return status;
}

/* Whether every preset can render the scene; `why` is the reason if not. */
static bool can_all_render(const struct work *work, const struct neph_scene *scene, char *why,
                           size_t size)
{
    for (int preset = 0; preset < work->params->preset_count; preset++)
        if (!can_render(work, scene, preset, why, size))
            return false;
    return true;
}

/* The frame count is a multiple of 4, and at most the scene's where it moves. */
static void describe(const struct work *work, const struct neph_scene *scene,
                     struct neph_study_scene *row)
{
    const int asked = work->params->frame_count;
    row->moves = !neph_scene_is_static(scene);
    row->frame_count = row->moves && scene->frame_count < asked ? scene->frame_count / 4 * 4
                                                                : asked;
    row->name = neph_arena_copy_text(&work->study->arena, scene->name);
    row->title = neph_arena_copy_text(&work->study->arena, scene->title);
}

/* Walks all sequences of a scene, if every preset can render it. */
static enum neph_status walk_scene(struct work *work, int index, bool is_counted,
                                   struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    struct neph_study_scene *row = &work->study->scenes[index];
    char why[512] = "";
    enum neph_status status = neph_data_load_scene(work->params->scenes[index], &scene, diag);
    const double rate_hz = work->params->frame_rate_hz;
    const char *obstacle = status ? NULL : neph_frame_rate_obstacle(scene, rate_hz);
    if (!status && !obstacle)
        status = neph_scene_set_frame_rate(scene, rate_hz, diag);
    if (!status && is_counted)
        describe(work, scene, row);
    snprintf(why, sizeof(why), "%s", obstacle ? obstacle : "");
    const bool can = !status && !obstacle && can_all_render(work, scene, why, sizeof(why));
    if (!status && !can)
        row->left_out = neph_arena_copy_text(&work->study->arena, why);
    for (int id = 0; id < NEPH_STUDY_CAPTURES && can && !status; id++)
        if (work->params->takes[id])
            status = walk_capture(work, scene, index, (enum neph_study_capture_id)id, is_counted,
                                  diag);
    neph_scene_destroy(scene);
    return status;
}

/* ---- the whole study ------------------------------------------------------------------------- */

enum neph_status neph_flicker_study_begin(const struct neph_flicker_study_params *params,
                                          struct neph_flicker_study *study, struct neph_diag *diag)
{
    const size_t rows = (size_t)compute_row_index(params, params->scene_count, 0, 0);
    const size_t cells = rows * (size_t)neph_study_metric_count();
    *study = (struct neph_flicker_study){.params = params};
    study->scenes = neph_arena_allocate(&study->arena, (size_t)params->scene_count,
                                        sizeof(*study->scenes));
    study->cells = neph_arena_allocate(&study->arena, cells, sizeof(*study->cells));
    study->costs = neph_arena_allocate(&study->arena, rows, sizeof(*study->costs));
    return neph_arena_check(&study->arena, diag);
}

static enum neph_status describe_presets(struct work *work, struct neph_diag *diag)
{
    struct neph_flicker_study *study = work->study;
    enum neph_status status = NEPH_OK;
    for (int preset = 0; preset < count_configurations(work->params) && !status; preset++) {
        struct neph_job job;
        status = make_job(work, NULL, work->params->presets[preset], 1, &job, diag);
        char *text = status ? NULL : neph_settings_text(job.engine, &job.shot.settings);
        study->settings[preset] = neph_arena_copy_text(&study->arena, text);
        if (!status && !text)
            status = neph_fail_memory(diag);
        free(text);
    }
    return status;
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    struct neph_flicker_study *study = work->study;
    const enum neph_status status = neph_flicker_study_begin(work->params, study, diag);
    const int rows = status ? 0 : compute_row_index(work->params, work->params->scene_count, 0, 0);
    for (int i = 0; i < rows; i++)
        study->costs[i] = (struct neph_study_cost){NAN, NAN, NAN, NAN, NULL};
    for (int i = 0; i < rows * neph_study_metric_count(); i++) {
        study->cells[i] = (struct neph_study_cell){.value = NAN, .centre = NAN};
        for (int k = 0; k < NEPH_IDEALS; k++)
            study->cells[i].ideals[k] = NAN;
        for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
            study->cells[i].displays[d] = NAN;
        set_cell_reason(&study->cells[i], "not asked for");
    }
    snprintf(study->device, sizeof(study->device), "%s", work->info.device);
    return status ? status : describe_presets(work, diag);
}

enum neph_status neph_flicker_study_run(const struct neph_flicker_study_params *params,
                                        struct neph_store *store, struct neph_flicker_study *study,
                                        struct neph_diag *diag)
{
    struct work work = {.params = params,
                        .study = study,
                        .store = store,
                        .progress = neph_progress_start(params->quiet, 0)};
    neph_engine_probe(neph_engine_find("realtime"), params->device, &work.info);
    neph_engine_probe(neph_engine_find("command"), params->device, &work.user_engine_info);
    enum neph_status status = prepare(&work, diag);
    /* first pass: load every scene, so that a wrong name is an error before any rendering */
    for (int i = 0; i < 2 * params->scene_count && !status; i++)
        status = walk_scene(&work, i % params->scene_count, i < params->scene_count, diag);
    if (!status)
        status = neph_arena_check(&study->arena, diag);
    neph_progress_end(&work.progress);
    neph_reference_finish(&work.reference);
    neph_ideal_finish(&work.ideal);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    return status;
}

void neph_flicker_study_finish(struct neph_flicker_study *study)
{
    neph_arena_finish(&study->arena);
    *study = (struct neph_flicker_study){.params = NULL};
}

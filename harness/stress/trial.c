/* SPDX-License-Identifier: MIT
 *
 * One trial: job, reference, measurement, verdicts, evidence.
 */
#include "harness/stress/trial.h"

#include "base/clock.h"
#include "harness/engines/engines.h"
#include "harness/run/seed.h"
#include "harness/stress/evidence.h"
#include "harness/stress/expectations.h"
#include "harness/stress/measures.h"
#include "harness/stress/watch.h"
#include "harness/study/take.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as trials handle each measure and verdict. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");
_Static_assert(NEPH_STRESS_IMAGES_COUNT == 4, "a new kind");
_Static_assert(NEPH_STRESS_VERDICTS == 12, "a new kind");

/* Name of the measurement set, part of its store key; the name of earlier versions is kept. */
static const char reading_name[] = "failure";

/* Time limit of a child process for a small frame, long enough for a loaded machine. */
static const double engine_limit_s = 300.0;

/* ---- points ---------------------------------------------------------------------------------- */

struct neph_stress_point neph_stress_point_at(const struct neph_stress_suite *suite, int row)
{
    const struct neph_stress_row *first = &suite->rows[row];
    struct neph_stress_point point = {.scene = first->scene, .first_row = row};
    while (row + point.row_count < suite->row_count &&
           first[point.row_count].scene == first->scene &&
           first[point.row_count].point_index == first->point_index)
        point.row_count++;
    return point;
}

bool neph_stress_has_trial(const struct neph_stress_suite *suite,
                           const struct neph_stress_point *point, int column)
{
    for (int r = 0; r < point->row_count; r++)
        if (suite->rows[point->first_row + r].cells[column].verdict != NEPH_STRESS_NOT_PLANNED)
            return true;
    return false;
}

/* ---- names and kinds ------------------------------------------------------------------------- */

void neph_stress_name(const struct neph_stress_suite *suite, const struct neph_stress_point *point,
                      int column, char name[NEPH_STRESS_NAME_SIZE])
{
    const char *at = suite->rows[point->first_row].point;
    const char *kind = column >= suite->column_count      ? "floor"
                       : suite->columns[column].is_preset ? "preset"
                                                          : "engine";
    snprintf(name, NEPH_STRESS_NAME_SIZE, "%s%s%s, %s %s", point->scene->name, *at ? " " : "", at,
             kind, suite->columns[column].name);
}

int neph_stress_kind(const struct neph_stress_suite *suite, int column)
{
    return suite->columns[column].is_preset ? NEPH_STRESS_KIND_TAKE
                                            : NEPH_STRESS_KIND_ENGINE + column;
}

/* ---- jobs ------------------------------------------------------------------------------------ */

/* The state of a running trial. */
struct trial {
    struct neph_stress_context *bench;
    struct neph_stress_point *point;
    int column;
    struct neph_job job;
    struct neph_stress_frames frames;
    struct neph_reference *reference;
    const char *extractors[NEPH_FAILING_MEASURES + 1]; /* NULL-terminated */
    bool has_verdicts;                                 /* the cells are filled; frames are only
                                                          drawn */
    char evidence_key[NEPH_HASH_HEX_SIZE];
};

static const struct neph_stress_column *trial_column(const struct trial *trial)
{
    return &trial->bench->suite->columns[trial->column];
}

/* A floor has values only: no verdicts, no evidence. */
static bool is_floor(const struct trial *trial)
{
    return trial->column >= trial->bench->suite->column_count;
}

static struct neph_stress_row *trial_row(const struct trial *trial, int number)
{
    return &trial->bench->suite->rows[trial->point->first_row + number];
}

static struct neph_stress_cell *trial_cell(const struct trial *trial, int number)
{
    return &trial_row(trial, number)->cells[trial->column];
}

/* Settings for small frames, whose limits are well above the noise. */
static const struct {
    const char *engine, *setting;
} engine_overrides[] = {{"cycles", "samples=16"}};

static enum neph_status set_engine(struct neph_job *job, struct neph_diag *diag)
{
    for (size_t i = 0; i < sizeof(engine_overrides) / sizeof(engine_overrides[0]); i++)
        if (neph_engine_is_kind(job->engine, engine_overrides[i].engine))
            return neph_settings_set(job->engine, &job->shot.settings, engine_overrides[i].setting,
                                     diag);
    return NEPH_OK;
}

/* Sets engine and settings from a column's name, also for a user engine. */
static enum neph_status set_words(const struct trial *trial, const char *words,
                                  struct neph_job *job, struct neph_diag *diag)
{
    char steps[32];
    snprintf(steps, sizeof(steps), "steps=%d", trial->point->at->failing->steps);
    const enum neph_status status = neph_engine_parse_words(words, steps, &job->engine,
                                                            &job->shot.settings, diag);
    if (!status)
        neph_settings_adapt_to_scene(job->engine, trial->point->at, &job->shot.settings);
    return status;
}

static enum neph_status make_job(struct trial *trial, struct neph_diag *diag)
{
    const struct neph_stress_column *column = trial_column(trial);
    const struct neph_stress_params *params = trial->bench->params;
    const struct neph_failing *failing = trial->point->at->failing;
    const bool has_own_size = params->width_px == 0;
    trial->job = (struct neph_job){
        .engine = column->engine,
        .info = &trial->bench->infos[trial->column],
        .shot = {.scene = trial->point->at,
                 .settings = neph_settings_default(column->engine),
                 .width_px = has_own_size ? failing->width_px : params->width_px,
                 .height_px = has_own_size ? failing->height_px : params->height_px,
                 /* external renderers need a render for each layer */
                 .layers = column->engine->rung == NEPH_LEVEL_EXTERNAL ? NEPH_LAYER_RADIANCE
                                                                       : NEPH_LAYERS_ALL,
                 .seed = neph_seed_for_scene(trial->point->at, 1),
                 .time_limit_s = column->engine->is_user_engine ? NEPH_USER_ENGINE_LIMIT_S
                                 : column->is_preset            ? 0.0
                                                                : engine_limit_s,
                 .device = params->device}};
    if (column->engine->is_user_engine && trial_row(trial, 0)->point_index > 0)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "a program reads the scene file, which has no values of a sweep point");
    return column->is_preset ? set_words(trial, column->name, &trial->job, diag)
                             : set_engine(&trial->job, diag);
}

/* Makes the reference at the first trial of a point. The presets' reference is the marcher at the
 * settings of preset `off`. */
static enum neph_status make_truth(struct trial *trial, struct neph_diag *diag)
{
    struct neph_stress_context *bench = trial->bench;
    struct neph_job job = trial->job;
    if (bench->params->width_px > 0 || trial->reference->frames[NEPH_REFERENCE_AVERAGED].count > 0)
        return NEPH_OK;
    if (!trial_column(trial)->is_preset)
        return trial->extractors[0] ? neph_stress_engine_truth(&trial->job, &trial->frames,
                                                               bench->store, trial->reference, diag)
                                    : NEPH_OK;
    const enum neph_status status = set_words(trial, "off", &job, diag);
    job.shot.time_limit_s = 0.0;
    bench->progress.kind = NEPH_STRESS_KIND_REFERENCE;
    return status ? status
                  : neph_stress_preset_truth(&job, bench->store, &bench->progress, trial->reference,
                                             diag);
}

static struct neph_viewing make_trial_viewing(const struct neph_scene *scene)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = neph_scene_display(scene)->exposure_ev;
    viewing.frame_rate_hz = 30.0;
    viewing.pixels_per_degree = 60.0;
    return viewing;
}

/* ---- cells ----------------------------------------------------------------------------------- */

static enum neph_stress_expected find_expectation(const struct trial *trial, int number,
                                                  const char **reason)
{
    const struct neph_stress_row *row = trial_row(trial, number);
    const struct neph_stress_place place = {row->scene->name, row->point, trial_column(trial)->name,
                                            neph_failing_measure_name(row->limit->measure),
                                            row->limit->over};
    return neph_stress_expected_at(trial->bench->expectations, &place, reason);
}

/* Fills a cell; `why` "": the reason of the expectation. */
static void fill_cell(const struct trial *trial, int number, double value, const char *why)
{
    struct neph_stress_cell *cell = trial_cell(trial, number);
    const char *reason;
    if (cell->verdict == NEPH_STRESS_NOT_PLANNED)
        return;
    const enum neph_stress_expected expected = find_expectation(trial, number, &reason);
    *cell = (struct neph_stress_cell){
        .value = value,
        .verdict = neph_stress_judge(value, trial_row(trial, number)->limit->limit, expected),
        .why = neph_arena_copy_text(&trial->bench->suite->arena, why[0] ? why : reason)};
}

/* Fills the cells from the document in a sequence's folder. */
static enum neph_status read_cells(const struct trial *trial, const char *folder, size_t bad_values,
                                   bool has_document, struct neph_diag *diag)
{
    json_t *document = NULL;
    enum neph_status status = NEPH_OK;
    if (bad_values == 0 && has_document)
        status = neph_capture_document(folder, reading_name, &document, diag);
    for (int r = 0; r < trial->point->row_count && !status; r++) {
        const struct neph_failing_limit *limit = trial_row(trial, r)->limit;
        char why[NEPH_STRESS_WHY_SIZE] = "";
        double value = NAN;
        if (limit->measure == NEPH_FAILING_BAD_VALUES)
            value = (double)bad_values;
        else if (document)
            value = neph_stress_read(limit, document, why);
        else
            snprintf(why, sizeof(why), "the frames have %zu bad values", bad_values);
        fill_cell(trial, r, value, why);
    }
    json_decref(document);
    return status;
}

/* Fills all cells without a value, with a reason. */
static void mark_cells(const struct trial *trial, enum neph_stress_verdict verdict, const char *why)
{
    for (int r = 0; r < trial->point->row_count; r++) {
        struct neph_stress_cell *cell = trial_cell(trial, r);
        fill_cell(trial, r, NAN, why);
        if (verdict != NEPH_STRESS_NO_NUMBER && cell->verdict == NEPH_STRESS_NO_NUMBER)
            cell->verdict = verdict;
    }
}

/* ---- evidence -------------------------------------------------------------------------------- */

static bool is_drawn(const struct trial *trial)
{
    const enum neph_stress_images wanted = trial->bench->params->pictures;
    bool is_wanted = false;
    for (int r = 0; r < trial->point->row_count && !is_floor(trial); r++) {
        const struct neph_stress_verdict_info *verdict =
            &neph_stress_verdicts[trial_cell(trial, r)->verdict];
        is_wanted |= verdict->is_compared &&
                     (wanted == NEPH_STRESS_IMAGES_ALL ||
                      (wanted != NEPH_STRESS_IMAGES_NONE && verdict->is_unexpected) ||
                      (wanted == NEPH_STRESS_IMAGES_FAILED && verdict->is_failure));
    }
    return is_wanted;
}

/* Callback: judges and draws the frames while they are in memory. */
static enum neph_status judge_and_draw(const struct neph_capture *take,
                                       const struct neph_capture_frames *frames, void *context,
                                       struct neph_diag *diag)
{
    const struct trial *trial = context;
    const struct neph_scene *scene = trial->point->at;
    const struct neph_viewing viewing = make_trial_viewing(scene);
    const struct neph_evidence_source source = {
        .files = frames->files,
        .images = frames->images,
        .reference = &take->reference->frames[NEPH_REFERENCE_AVERAGED],
        .frame_step = trial->frames.step,
        .exposure_ev = neph_scene_display(scene)->exposure_ev,
    };
    enum neph_status status = NEPH_OK;
    if (!trial->has_verdicts)
        status = read_cells(trial, frames->folder, frames->bad_values, take->reading_count > 0,
                            diag);
    if (status || !is_drawn(trial))
        return status;
    return neph_evidence_make(trial->bench->store, trial->evidence_key, &trial->job, &source,
                              &viewing, frames->bad_values == 0, diag);
}

/* Finds the evidence of judged frames. Where the store has none, for example after a limit was
 * changed, the frames are rendered again and drawn. */
static enum neph_status find_evidence(struct trial *trial, const struct neph_capture *take,
                                      struct neph_diag *diag)
{
    struct neph_stress_context *bench = trial->bench;
    enum neph_status status = NEPH_OK;
    if (!is_drawn(trial))
        return NEPH_OK;
    char *folder = neph_evidence_find(bench->store, trial->evidence_key);
    if (!folder) {
        trial->has_verdicts = true;
        status = neph_capture_replay(take, bench->store, diag);
        if (!status && !(folder = neph_evidence_find(bench->store, trial->evidence_key)))
            status = neph_fail(diag, NEPH_ERR_IO, "images are not readable after publishing");
    }
    for (int r = 0; r < trial->point->row_count && !status; r++)
        trial_cell(trial, r)->evidence = neph_arena_copy_text(&bench->suite->arena, folder);
    free(folder);
    return status;
}

/* ---- a trial --------------------------------------------------------------------------------- */

static enum neph_status measure_sequence_capture(struct trial *trial,
                                                 const struct neph_capture *take,
                                                 struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE], *folder = NULL;
    json_t *record = NULL;
    enum neph_status status = neph_capture_key(take, key, diag);
    if (!status)
        status = neph_evidence_key(key, neph_scene_display(trial->point->at)->exposure_ev,
                                   trial->evidence_key, diag);
    if (!status)
        status = neph_capture_run(take, trial->bench->store, &folder, &record, diag);
    if (!status)
        status = read_cells(trial, folder,
                            (size_t)json_integer_value(json_object_get(record, "bad_values")),
                            take->reading_count > 0, diag);
    for (int r = 0; r < trial->point->row_count && !status; r++)
        trial_cell(trial, r)->frame_key = neph_arena_copy_text(&trial->bench->suite->arena, key);
    if (!status)
        status = find_evidence(trial, take, diag);
    if (!status)
        trial->bench->suite->frame_count += take->frame_count;
    json_decref(record);
    free(folder);
    return status;
}

static enum neph_status measure(struct trial *trial, struct neph_diag *diag)
{
    const struct neph_failing *failing = trial->point->at->failing;
    const bool is_preset = trial_column(trial)->is_preset;
    struct neph_meter_number kept[NEPH_STRESS_METRICS_MAX];
    char step[40];
    neph_stress_list_metrics(failing, is_preset, kept);
    snprintf(step, sizeof(step), "lag.step_frame=%d", failing->event_frame);
    const char *const settings[] = {failing->event_frame > 0 ? step : NULL, NULL};
    const struct neph_measurement_set reading = {.name = reading_name,
                                                 .against = NEPH_REFERENCE_AVERAGED,
                                                 .extractors = trial->extractors,
                                                 .settings = settings,
                                                 .viewing = make_trial_viewing(trial->point->at),
                                                 .kept = kept};
    const bool is_read = trial->bench->params->width_px == 0 && (is_preset || trial->extractors[0]);
    const struct neph_capture take = {
        .job = trial->job,
        .frame_count = trial->frames.count,
        .frame_step = trial->frames.step,
        .reference = trial->reference,
        .readings = &reading,
        .reading_count = is_read ? 1 : 0,
        .plain = true, /* limits are compared with the values themselves
                                                     */
        .allow_frozen_frames = true,
        .look = judge_and_draw,
        .callback_context = trial,
        .counts_bad = true};
    return measure_sequence_capture(trial, &take, diag);
}

/* Renders every frame and keeps only the count of its bad values. */
static enum neph_status count_bad_values(struct trial *trial, struct neph_diag *diag)
{
    uint64_t bad = 0;
    const enum neph_status status = neph_count_bad_values(&trial->job, trial->frames.count, &bad,
                                                          diag);
    for (int r = 0; r < trial->point->row_count && !status; r++)
        fill_cell(trial, r, (double)bad, "");
    if (!status)
        trial->bench->suite->frame_count += trial->frames.count;
    return status;
}

static enum neph_status run(struct trial *trial, struct neph_diag *diag)
{
    const bool is_preset = trial_column(trial)->is_preset;
    struct neph_stress_point *point = trial->point;
    trial->reference = is_preset ? &point->presets : &point->engines;
    trial->frames = is_preset ? (struct neph_stress_frames){point->at->failing->frame_count, 1}
                              : neph_stress_engine_frames(point->at);
    neph_stress_extractors(point->at->failing, is_preset, trial->extractors);
    enum neph_status status = make_job(trial, diag);
    if (!status && !trial->bench->params->on_device)
        status = make_truth(trial, diag);
    trial->bench->progress.kind = neph_stress_kind(trial->bench->suite, trial->column);
    if (status)
        return status;
    return trial->bench->params->on_device ? count_bad_values(trial, diag) : measure(trial, diag);
}

/* Whether all values of the column are to be skipped. */
static bool is_skipped(const struct trial *trial)
{
    const char *reason;
    for (int r = 0; r < trial->point->row_count; r++)
        if (trial_cell(trial, r)->verdict != NEPH_STRESS_NOT_PLANNED &&
            find_expectation(trial, r, &reason) != NEPH_STRESS_SKIPS)
            return false;
    return true;
}

/* Whether an error concerns one column; all others end the run. An engine or a user engine may not
 * support a scene, or not be installed; a floor may fail. A preset must render every scenario. */
static bool is_column_error(const struct trial *trial, enum neph_status status,
                            enum neph_stress_verdict *verdict)
{
    static const struct {
        enum neph_status status;
        bool of_presets;
        enum neph_stress_verdict verdict; /* verdict of an engine */
    } table[] = {
        {NEPH_ERR_ENGINE, true, NEPH_STRESS_NO_NUMBER},
        {NEPH_ERR_GATE, true, NEPH_STRESS_NO_NUMBER},
        {NEPH_ERR_UNSUPPORTED, true, NEPH_STRESS_CANNOT},
        {NEPH_ERR_UNAVAILABLE, false, NEPH_STRESS_MISSING},
        {NEPH_ERR_TIMEOUT, false, NEPH_STRESS_NOT_RENDERED},
    };
    const struct neph_stress_column *column = trial_column(trial);
    const bool is_promise = column->is_preset && !column->engine->is_user_engine &&
                            !is_floor(trial);
    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (table[i].status == status) {
            *verdict = is_promise ? NEPH_STRESS_NO_NUMBER : table[i].verdict;
            return table[i].of_presets || !is_promise;
        }
    return false;
}

static enum neph_status try(struct trial *trial, const char *what, struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    enum neph_stress_verdict verdict;
    enum neph_status status = run(trial, &why);
    if (is_column_error(trial, status, &verdict)) {
        if (neph_stress_verdicts[verdict].is_unexpected)
            neph_progress_warn("%s: %s", what, why.message);
        mark_cells(trial, verdict, why.message);
        return NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    return status;
}

enum neph_status neph_stress_try(struct neph_stress_context *bench, struct neph_stress_point *point,
                                 int column, struct neph_diag *diag)
{
    struct trial trial = {.bench = bench, .point = point, .column = column};
    char what[NEPH_STRESS_NAME_SIZE];
    const double start_s = neph_wall_s();
    neph_stress_name(bench->suite, point, column, what);
    neph_progress_begin(&bench->progress, what);
    enum neph_status status = NEPH_OK;
    if (is_skipped(&trial))
        mark_cells(&trial, NEPH_STRESS_SKIP, "");
    else
        status = try(&trial, what, diag);
    bench->progress.kind = neph_stress_kind(bench->suite, column);
    if (!status)
        neph_progress_step(&bench->progress, what, "measured", neph_wall_s() - start_s);
    return status;
}

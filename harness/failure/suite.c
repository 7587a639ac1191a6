/* SPDX-License-Identifier: MIT */
#include "harness/failure/suite.h"

#include "base/clock.h"
#include "base/files.h"
#include "harness/engines/engines.h"
#include "harness/failure/expectations.h"
#include "harness/failure/measures.h"
#include "harness/failure/plan.h"
#include "harness/failure/share.h"
#include "harness/run/seed.h"
#include "harness/study/take.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_REFERENCE, KIND_TAKE }; /* of progress */

/* Guesses before the first is over, on two cores. */
static const double picture_typical_s = 0.2, take_typical_s = 3.0;

/* A picture of a user's program. */
static const double guest_limit_s = 600.0;

struct work {
    const struct neph_failure_params *params;
    struct neph_failure_suite *suite;
    struct neph_store *store;
    json_t *expectations;
    struct neph_progress progress;
    struct neph_engine_info info, guest; /* of realtime, and of the guest among the presets */
};

/* A point of a scenario, which is some rows in a row. */
struct place {
    const struct neph_scene *scene; /* as its file is */
    struct neph_scene *at;          /* at the point; owned */
    int index;                      /* of the point */
    int first_row, row_count;
    struct neph_reference reference; /* of the presets, which march the same steps */
};

/* ---- jobs ------------------------------------------------------------------------------------ */

static enum neph_status make_job(const struct work *work, const struct place *place,
                                 const char *preset, struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_failing *failing = &place->at->failing;
    const bool own_size = work->params->width_px == 0;
    char steps[32];
    snprintf(steps, sizeof(steps), "steps=%d", failing->steps);
    *job = (struct neph_job){
        .shot = {.scene = place->at,
                 .width_px = own_size ? failing->width_px : work->params->width_px,
                 .height_px = own_size ? failing->height_px : work->params->height_px,
                 .layers = NEPH_LAYERS_ALL,
                 .time_limit_s = guest_limit_s,
                 .seed = neph_seed_of(place->at, 1)}};
    const enum neph_status status = neph_engine_words(preset, steps, &job->engine,
                                                      &job->shot.settings, diag);
    if (status)
        return status;
    job->info = job->engine->is_guest ? &work->guest : &work->info;
    return job->engine->is_guest && place->index > 0
               ? neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                           "a program reads the file, which has other values")
               : NEPH_OK;
}

/* ---- the truth ------------------------------------------------------------------------------- */

static bool stands_still(const struct neph_scene *scene, int frame_count)
{
    for (int frame = 1; frame < frame_count; frame++)
        if (!neph_scene_is_same_moment(scene, 0, frame))
            return false;
    return true;
}

/* One picture of engine exact for all frames. */
static enum neph_status make_exact(const struct neph_job *test, struct neph_store *store,
                                   struct neph_reference *reference, struct neph_diag *diag)
{
    const struct neph_engine *exact = neph_engine_find("exact");
    struct neph_engine_info info;
    struct neph_job_result result = {.settings = NULL};
    struct neph_job job = {.engine = exact, .info = &info, .shot = test->shot};
    neph_engine_probe(exact, &info);
    job.shot.settings = neph_settings_default(exact);
    job.shot.seed = 1; /* nothing is random */
    enum neph_status status = neph_job_run(&job, store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_job_key(&job, reference->key, diag);
    struct neph_sequence *frames = &reference->frames[NEPH_REFERENCE_AVERAGED];
    if (!status && !(frames->paths = calloc(1, sizeof(*frames->paths))))
        status = neph_fail_memory(diag);
    if (!status) {
        frames->paths[0] = result.frame_path;
        result.frame_path = NULL;
        frames->count = 1;
    }
    neph_job_result_finish(&result);
    return status;
}

/* That of all presets, also where a guest is the first. */
static enum neph_status make_march(struct work *work, struct place *place, struct neph_diag *diag)
{
    struct neph_job job;
    const enum neph_status status = make_job(work, place, "off", &job, diag);
    return status ? status
                  : neph_reference_make(&job, place->at->failing.frame_count, work->store,
                                        &work->progress, &place->reference, diag);
}

static enum neph_status make_truth(struct work *work, const struct neph_job *job,
                                   struct place *place, struct neph_diag *diag)
{
    const struct neph_failing *failing = &place->at->failing;
    if (failing->truth == NEPH_FAILING_MARCH)
        return job->engine->is_guest
                   ? make_march(work, place, diag)
                   : neph_reference_make(job, failing->frame_count, work->store, &work->progress,
                                         &place->reference, diag);
    if (!stands_still(place->at, failing->frame_count))
        return neph_fail(diag, NEPH_ERR_INPUT, "%s moves: `truth: exact` is of what stands still",
                         place->scene->name);
    return make_exact(job, work->store, &place->reference, diag);
}

/* The first preset that is measured at a place makes it. */
static enum neph_status have_truth(struct work *work, const struct neph_job *job,
                                   struct place *place, struct neph_diag *diag)
{
    if (work->params->width_px > 0 || place->reference.frames[NEPH_REFERENCE_AVERAGED].count > 0)
        return NEPH_OK;
    work->progress.kind = KIND_REFERENCE;
    return make_truth(work, job, place, diag);
}

/* ---- one preset ------------------------------------------------------------------------------ */

static struct neph_viewing viewing_of(const struct neph_scene *scene)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = scene->exposure_ev;
    viewing.frame_rate_hz = 30.0;
    viewing.pixels_per_degree = 60.0;
    return viewing;
}

static struct neph_failure_place number_of(const struct neph_failure_row *row, const char *preset)
{
    return (struct neph_failure_place){row->scene->name, row->point, preset,
                                       neph_failing_measure_name(row->limit->measure),
                                       row->limit->over};
}

/* A number of a row; NaN with `why`. */
static double value_of(const struct neph_failure_row *row, size_t bad_values,
                       const json_t *document, char why[NEPH_FAILURE_WHY_SIZE])
{
    if (row->limit->measure == NEPH_FAILING_BAD_VALUES)
        return (double)bad_values;
    if (document)
        return neph_failure_read(row->limit, document, why);
    snprintf(why, NEPH_FAILURE_WHY_SIZE, "the frames hold %zu bad values", bad_values);
    return NAN;
}

static void fill_cell(struct work *work, struct neph_failure_row *row, int preset, double value,
                      const char *why)
{
    const struct neph_failure_place place = number_of(row, work->suite->presets[preset]);
    const char *reason;
    const enum neph_failure_expected expected = neph_failure_expected_at(work->expectations, &place,
                                                                         &reason);
    const char *words = why[0] ? why : reason;
    row->cells[preset] = (struct neph_failure_cell){
        value, neph_failure_judge(value, row->limit->limit, expected),
        neph_arena_text(&work->suite->arena, words)};
}

static enum neph_status read_cells(struct work *work, const struct place *place, int preset,
                                   const char *folder, const json_t *record, struct neph_diag *diag)
{
    const size_t bad = (size_t)json_integer_value(json_object_get(record, "bad_values"));
    json_t *document = NULL;
    enum neph_status status = NEPH_OK;
    if (bad == 0 && work->params->width_px == 0)
        status = neph_take_document(folder, "failure", &document, diag);
    for (int r = 0; r < place->row_count && !status; r++) {
        struct neph_failure_row *row = &work->suite->rows[place->first_row + r];
        char why[NEPH_FAILURE_WHY_SIZE] = "";
        const double value = value_of(row, bad, document, why);
        fill_cell(work, row, preset, value, why);
    }
    json_decref(document);
    return status;
}

static enum neph_status run_take(struct work *work, struct place *place, int preset,
                                 struct neph_diag *diag)
{
    const struct neph_failing *failing = &place->at->failing;
    const char *extractors[NEPH_FAILING_MEASURES + 1];
    struct neph_meter_number kept[NEPH_FAILURE_KEPT_MAX];
    struct neph_job job;
    char step[40], *folder = NULL;
    json_t *record = NULL;
    enum neph_status status = make_job(work, place, work->suite->presets[preset], &job, diag);
    if (!status)
        status = have_truth(work, &job, place, diag);
    if (status)
        return status;
    neph_failure_extractors(failing, extractors);
    neph_failure_kept(failing, kept);
    snprintf(step, sizeof(step), "lag.step_frame=%d", failing->event_frame);
    const char *const settings[] = {failing->event_frame > 0 ? step : NULL, NULL};
    const struct neph_reading reading = {
        "failure", NEPH_REFERENCE_AVERAGED, extractors, settings, viewing_of(place->at), kept, 0};
    const struct neph_take take = {.job = job,
                                   .frame_count = failing->frame_count,
                                   .reference = &place->reference,
                                   .readings = &reading,
                                   .reading_count = work->params->width_px > 0 ? 0 : 1,
                                   .plain = true, /* a limit is held against the number itself */
                                   .frozen_is_fine = true,
                                   .counts_bad = true};
    status = neph_take_run(&take, work->store, &folder, &record, diag);
    if (!status)
        status = read_cells(work, place, preset, folder, record, diag);
    work->suite->frame_count += failing->frame_count;
    json_decref(record);
    free(folder);
    return status;
}

/* Whether every number of a preset at a place is one that is skipped. */
static bool is_skipped(const struct work *work, const struct place *place, int preset)
{
    for (int r = 0; r < place->row_count; r++) {
        const struct neph_failure_row *row = &work->suite->rows[place->first_row + r];
        const struct neph_failure_place number = number_of(row, work->suite->presets[preset]);
        const char *reason;
        if (neph_failure_expected_at(work->expectations, &number, &reason) != NEPH_FAILURE_SKIPS)
            return false;
    }
    return true;
}

static void mark_cells(struct work *work, const struct place *place, int preset, const char *why)
{
    for (int r = 0; r < place->row_count; r++)
        fill_cell(work, &work->suite->rows[place->first_row + r], preset, NAN, why);
}

/* What breaks or cannot be rendered is news of one preset; what ends the run goes on. */
static bool is_of_one_preset(enum neph_status status)
{
    return status == NEPH_ERR_ENGINE || status == NEPH_ERR_GATE || status == NEPH_ERR_UNSUPPORTED ||
           status == NEPH_ERR_TIMEOUT;
}

static enum neph_status try_preset(struct work *work, struct place *place, int preset,
                                   struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    char what[256];
    const double start_s = neph_wall_s();
    if (is_skipped(work, place, preset)) {
        mark_cells(work, place, preset, "");
        return NEPH_OK;
    }
    snprintf(what, sizeof(what), "%s %s, preset %s", place->scene->name,
             work->suite->rows[place->first_row].point, work->suite->presets[preset]);
    neph_progress_begin(&work->progress, what);
    enum neph_status status = run_take(work, place, preset, &why);
    work->progress.kind = KIND_TAKE;
    if (is_of_one_preset(status)) {
        neph_progress_warn("%s: %s", what, why.message);
        mark_cells(work, place, preset, why.message);
        status = NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    if (!status)
        neph_progress_step(&work->progress, what, "measured", neph_wall_s() - start_s);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool is_same_place(const struct neph_failure_row *a, const struct neph_failure_row *b)
{
    return a->scene == b->scene && a->point_index == b->point_index;
}

static struct place place_at(const struct neph_failure_suite *suite, int first_row)
{
    struct place place = {.scene = suite->rows[first_row].scene,
                          .index = suite->rows[first_row].point_index,
                          .first_row = first_row};
    while (first_row + place.row_count < suite->row_count &&
           is_same_place(&suite->rows[first_row], &suite->rows[first_row + place.row_count]))
        place.row_count++;
    return place;
}

static enum neph_status run_place(struct work *work, struct place *place, struct neph_diag *diag)
{
    enum neph_status status = neph_scene_load_point(place->scene, place->index, &place->at, diag);
    for (int preset = 0; preset < work->suite->preset_count && !status; preset++)
        if (neph_failure_has_preset(&place->scene->failing, work->suite->presets[preset]))
            status = try_preset(work, place, preset, diag);
    neph_reference_finish(&place->reference);
    neph_scene_destroy(place->at);
    return status;
}

/* The pictures and takes of a place. */
static void expect_place(struct work *work, const struct neph_scene *scene)
{
    const struct neph_failing *failing = &scene->failing;
    const bool marches = failing->truth == NEPH_FAILING_MARCH && work->params->width_px == 0;
    const int pictures = marches ? neph_reference_picture_count(scene, 0, failing->frame_count) : 0;
    int takes = 0;
    for (int preset = 0; preset < work->suite->preset_count; preset++)
        takes += neph_failure_has_preset(failing, work->suite->presets[preset]);
    neph_progress_expect(&work->progress, KIND_REFERENCE, takes > 0 ? pictures : 0,
                         picture_typical_s);
    neph_progress_expect(&work->progress, KIND_TAKE, takes, take_typical_s);
}

static void expect(struct work *work, const struct neph_share *share)
{
    int index = 0;
    for (int row = 0; row < work->suite->row_count; index++) {
        const struct place place = place_at(work->suite, row);
        if (neph_share_has(share, index))
            expect_place(work, place.scene);
        row += place.row_count;
    }
}

/* The places of a share, one after the other. */
static enum neph_status run_share(const struct neph_share *share, void *context,
                                  struct neph_diag *diag)
{
    struct work *work = context;
    struct neph_failure_suite *suite = work->suite;
    enum neph_status status = NEPH_OK;
    int index = 0;
    work->progress = neph_progress_start(work->params->quiet || share->index > 0, 0);
    neph_engine_probe(neph_engine_find("realtime"), &work->info);
    neph_engine_probe(neph_engine_find("command"), &work->guest);
    snprintf(suite->device, sizeof(suite->device), "%s", work->info.device);
    suite->frame_count = 0;
    expect(work, share);
    for (int row = 0; row < suite->row_count && !status; index++) {
        struct place place = place_at(suite, row);
        if (neph_share_has(share, index))
            status = run_place(work, &place, diag);
        row += place.row_count;
    }
    neph_progress_end(&work->progress);
    return status;
}

enum neph_status neph_failure_run(const struct neph_failure_params *params,
                                  struct neph_store *store, struct neph_failure_suite *suite,
                                  struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct work work = {.params = params, .suite = suite, .store = store};
    enum neph_status status = neph_failure_plan(params, suite, diag);
    if (!status)
        status = neph_failure_expectations_load(NULL, &work.expectations, diag);
    if (!status)
        status = neph_shares_run(params->jobs, run_share, &work, diag);
    json_decref(work.expectations);
    neph_failure_count(suite);
    suite->seconds = neph_wall_s() - start_s;
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status ? status : neph_arena_check(&suite->arena, diag);
}

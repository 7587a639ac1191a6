/* SPDX-License-Identifier: MIT
 *
 * Measures one point of a sweep: error, flicker, lag, density evaluations.
 */
#include "harness/sweep/point.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/engines/engines.h"
#include "harness/engines/frame_stats.h"
#include "harness/study/flicker_metrics.h"
#include "harness/study/floor_plan.h"
#include "harness/study/take.h"
#include "harness/sweep/repeat.h"
#include "scenes/display.h"
#include "scenes/motion.h"
#include "scenes/variant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a value is added, as this file measures each of them. */
_Static_assert(NEPH_SWEEP_NUMBERS == 5, "a new kind");

/* A sequence with a step is as long as in a flicker study. */
enum { STEP_FRAMES = 80 };

static const char *const of_flicker[] = {"seen", "flicker", "error", NULL};
static const char *const of_error[] = {"error",
                                       NULL}; /* of a sequence without a measured flicker */
static const char *const of_lag[] = {"lag", NULL};
static const char *const at_step[] = {"lag.step_frame=32", NULL};
_Static_assert(NEPH_STUDY_EVENT_FRAME == 32, "at_step");

/* The mask of flicker: depth edges, where methods fail, or all pixels of a scene without edges. */
static const char *const masks[] = {"depth_edge", "all"};

static const struct neph_meter_number kept_of_flicker[] = {
    {"seen_contrast", "depth_edge"},
    {"seen_contrast", "all"},
    {"a4_p95", "depth_edge"},
    {"a4_p95", "all"},
    {"rel_rmse", "all"},
    {.metric = NULL},
};
static const struct neph_meter_number kept_of_error[] = {
    {"rel_rmse", "all"},
    {.metric = NULL},
};
static const struct neph_meter_number kept_of_lag[] = {
    {"half_life_p50", "all"},
    {.metric = NULL},
};

void neph_sweep_context_finish(struct neph_sweep_context *bench)
{
    neph_reference_finish(&bench->still);
    neph_reference_finish(&bench->stepped);
    for (int i = 0; i <= NEPH_SCATTERING_MULTIPLE; i++)
        neph_scene_destroy(bench->steps[i]);
}

bool neph_sweep_is_sequence(const struct neph_sweep_point *point)
{
    return point->job.engine->has_frame_history || point->series->flicker || point->series->lag_at;
}

/* --- values --------------------------------------------------------------------------------- */

static struct neph_sweep_value read_value_with_interval(const json_t *found)
{
    const json_t *value = json_object_get(found, "value"),
                 *interval = json_object_get(found, "interval"), *low = json_array_get(interval, 0),
                 *high = json_array_get(interval, 1);
    return (struct neph_sweep_value){
        json_is_number(value) ? json_number_value(value) : NAN,
        json_is_number(low) ? json_number_value(low) : NAN,
        json_is_number(high) ? json_number_value(high) : NAN,
    };
}

/* With the first mask that the scene has. */
static struct neph_sweep_value number_in(const json_t *document, enum neph_sweep_number number)
{
    const char *metric = neph_sweep_number_texts[number].metric;
    const json_t *found = NULL;
    for (size_t i = 0; i < sizeof(masks) / sizeof(masks[0]) && !found; i++)
        found = neph_capture_find_value(document, metric, masks[i]);
    return read_value_with_interval(found);
}

/* Paths of traced light and cells of diffused light evaluate densities that are not counted. */
static bool is_counted(const struct neph_job *job)
{
    static const char *const uncounted[] = {"traced", "diffused"};
    const int option = neph_option_find(job->engine->options, "lighting");
    const char *light =
        option < 0 ? job->engine->name + strcspn(job->engine->name, "_")
                   : job->engine->options[option].choices[(int)job->shot.settings.values[option]];
    light += *light == '_';
    for (size_t i = 0; i < sizeof(uncounted) / sizeof(uncounted[0]); i++)
        if (strcmp(light, uncounted[i]) == 0)
            return false;
    return true;
}

double neph_sweep_evaluations(const struct neph_job *job, const struct neph_image *frame)
{
    json_t *stats = neph_frame_stats(frame);
    const json_t *count = json_object_get(stats, "density_evaluations");
    const double evaluations = json_is_number(count) && is_counted(job) ? json_number_value(count)
                                                                        : NAN;
    json_decref(stats);
    return evaluations;
}

enum neph_status neph_sweep_point_count(const char *frame_path, struct neph_sweep_point *point,
                                        struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    const enum neph_status status = neph_exr_read(frame_path, &image, diag);
    if (status)
        return status;
    neph_store_key_from_path(frame_path, point->frame_key);
    const double evaluations = neph_sweep_evaluations(&point->job, image);
    if (!isnan(evaluations))
        point->evaluations = evaluations / (double)neph_image_pixel_count(image);
    neph_image_destroy(image);
    return NEPH_OK;
}

/* --- sequences ------------------------------------------------------------------------------ */

static const double reference_typical_s = 1.0; /* per frame */

static enum neph_status ensure_point_reference(struct neph_sweep_context *bench,
                                               const struct neph_job *job, int frame_count,
                                               struct neph_reference *reference,
                                               struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_reference_key(job, frame_count, key, diag);
    if (status || (reference->text && strcmp(reference->key, key) == 0))
        return status;
    neph_reference_finish(reference);
    neph_progress_expect(bench->progress, bench->progress->kind,
                         neph_reference_frame_count(job->shot.scene, job->shot.frame, frame_count),
                         reference_typical_s);
    return neph_reference_make(job, frame_count, bench->store, bench->progress, reference, diag);
}

static struct neph_viewing make_scene_viewing(const struct neph_scene *scene)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = neph_scene_display(scene)->exposure_ev;
    return viewing;
}

/* Reads the values of one seed's sequence: the document's values, and the error of its last frame.
 * With `counts` the evaluations of this frame become the point's. */
static enum neph_status
read_sequence(struct neph_sweep_context *bench, struct neph_sweep_point *point,
              const struct neph_capture *take, const char *folder, bool counts,
              struct neph_sweep_value numbers[NEPH_SWEEP_NUMBERS], struct neph_diag *diag)
{
    json_t *document = NULL;
    const struct neph_path last = neph_path_in(folder, "frame.exr");
    enum neph_status status = neph_capture_document(folder, take->readings[0].name, &document,
                                                    diag);
    if (!status) {
        if (!point->job.engine
                 ->is_user_engine) /* the lighting model of a user's engine is unknown */
            numbers[NEPH_SWEEP_SHORTCUT] = number_in(document, NEPH_SWEEP_SHORTCUT);
        numbers[NEPH_SWEEP_FLICKER] = number_in(document, NEPH_SWEEP_FLICKER);
        numbers[NEPH_SWEEP_FOUR] = number_in(document, NEPH_SWEEP_FOUR);
        if (point->series->flicker)
            bench->mask = neph_capture_find_value(document, "seen_contrast", masks[0]) ? masks[0]
                                                                                       : masks[1];
        status = neph_sweep_truth_error(bench->truth, last.text, &numbers[NEPH_SWEEP_ERROR], diag);
    }
    if (!status && counts)
        status = neph_sweep_point_count(last.text, point, diag);
    json_decref(document);
    return status;
}

static enum neph_status measure_sequence(struct neph_sweep_context *bench,
                                         struct neph_sweep_point *point, struct neph_diag *diag)
{
    const bool flickers = point->series->flicker;
    const struct neph_measurement_set reading = {
        .name = "sweep",
        .against = NEPH_REFERENCE_AVERAGED,
        .extractors = flickers ? of_flicker : of_error,
        .viewing = make_scene_viewing(point->job.shot.scene),
        .kept = flickers ? kept_of_flicker : kept_of_error,
        .warm_up_frames = bench->plan->warm_up};
    struct neph_capture take = {.job = point->job,
                                .frame_count = bench->frame_count,
                                .reference = &bench->still,
                                .readings = &reading,
                                .reading_count = 1,
                                .allow_frozen_frames = true};
    struct neph_sweep_value of_seeds[NEPH_SWEEP_SEEDS_MAX][NEPH_SWEEP_NUMBERS];
    const int seed_count = point->job.engine->stochastic ? bench->plan->seed_count : 1;
    enum neph_status status = ensure_point_reference(bench, &point->job, bench->frame_count,
                                                     &bench->still, diag);
    for (int i = 0; i < seed_count && !status; i++) {
        char *folder = NULL;
        json_t *record = NULL;
        take.job.shot.seed = neph_sweep_seed(bench->seed, i);
        memcpy(of_seeds[i], point->numbers, sizeof(of_seeds[i]));
        status = neph_capture_run(&take, bench->store, &folder, &record, diag);
        if (!status)
            status = read_sequence(bench, point, &take, folder, i == 0, of_seeds[i], diag);
        json_decref(record);
        free(folder);
    }
    for (int n = 0; n < NEPH_SWEEP_NUMBERS && !status; n++) {
        struct neph_sweep_value values[NEPH_SWEEP_SEEDS_MAX];
        for (int i = 0; i < seed_count; i++)
            values[i] = of_seeds[i][n];
        point->numbers[n] = neph_sweep_average_seeds(values, seed_count);
    }
    return status;
}

/* The scene with a step of its sun; NULL: the scene has no sun to step. */
static enum neph_status ensure_step_scene(struct neph_sweep_context *bench,
                                          const struct neph_scene *scene,
                                          const struct neph_scene **step, struct neph_diag *diag)
{
    const struct neph_variant variant = {NEPH_VARIANT_SUN_STEP, NEPH_STUDY_EVENT_FRAME,
                                         STEP_FRAMES};
    struct neph_scene **made = &bench->steps[scene->scattering];
    enum neph_status status = NEPH_OK;
    if (!*made && !neph_variant_obstacle(scene, NEPH_VARIANT_SUN_STEP))
        status = neph_scene_variant(scene, &variant, made, diag);
    *step = *made;
    return status;
}

/* A half-life that is never reached is reported as the number of frames after the step (neph
 * metrics lag); it becomes NaN. */
static struct neph_sweep_value drop_unreached_half_life(struct neph_sweep_value half_life)
{
    return half_life.value < STEP_FRAMES - NEPH_STUDY_EVENT_FRAME
               ? half_life
               : (struct neph_sweep_value){NAN, NAN, NAN};
}

static enum neph_status measure_lag(struct neph_sweep_context *bench,
                                    struct neph_sweep_point *point, struct neph_diag *diag)
{
    const struct neph_measurement_set reading = {
        .name = "step",
        .against = NEPH_REFERENCE_AVERAGED,
        .extractors = of_lag,
        .settings = at_step,
        .viewing = make_scene_viewing(point->job.shot.scene),
        .kept = kept_of_lag};
    struct neph_capture take = {.job = point->job,
                                .frame_count = STEP_FRAMES,
                                .reference = &bench->stepped,
                                .readings = &reading,
                                .reading_count = 1,
                                .allow_frozen_frames = true};
    char *folder = NULL;
    json_t *record = NULL, *document = NULL;
    enum neph_status status = ensure_step_scene(bench, point->job.shot.scene, &take.job.shot.scene,
                                                diag);
    if (status || !take.job.shot.scene)
        return status;
    status = ensure_point_reference(bench, &take.job, STEP_FRAMES, &bench->stepped, diag);
    if (!status)
        status = neph_capture_run(&take, bench->store, &folder, &record, diag);
    if (!status)
        status = neph_capture_document(folder, reading.name, &document, diag);
    if (!status)
        point->numbers[NEPH_SWEEP_HALF_LIFE] = drop_unreached_half_life(
            number_in(document, NEPH_SWEEP_HALF_LIFE));
    json_decref(document);
    json_decref(record);
    free(folder);
    return status;
}

/* --- floors --------------------------------------------------------------------------------- */

/* Whether an error concerns this point only. */
static bool is_point_error(enum neph_status status)
{
    return status == NEPH_ERR_ENGINE || status == NEPH_ERR_UNSUPPORTED || status == NEPH_ERR_GATE ||
           status == NEPH_ERR_UNAVAILABLE || status == NEPH_ERR_TIMEOUT;
}

/* The numbers of a configuration of a point's floor. */
static enum neph_status measure_floor(struct neph_sweep_context *bench,
                                      const struct neph_sweep_point *point,
                                      const struct neph_settings *settings,
                                      struct neph_sweep_point *floor, struct neph_diag *diag)
{
    *floor = *point;
    floor->job.shot.settings = *settings;
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        floor->numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
    const enum neph_status status = measure_sequence(bench, floor, diag);
    return status || !neph_sweep_has_lag(point->series, point->place)
               ? status
               : measure_lag(bench, floor, diag);
}

/* The lower number of both configurations, for a preset in a scene that moves; none where one of
 * them cannot be rendered. */
static enum neph_status measure_floors(struct neph_sweep_context *bench,
                                       struct neph_sweep_point *point, struct neph_diag *diag)
{
    struct neph_settings settings[NEPH_STUDY_FLOOR_CANDIDATES];
    struct neph_sweep_point floors[NEPH_STUDY_FLOOR_CANDIDATES];
    if (!bench->with_floors || !point->series->flicker ||
        !neph_engine_is_kind(point->job.engine, "realtime") ||
        neph_scene_is_static(point->job.shot.scene))
        return NEPH_OK;
    enum neph_status status = neph_floor_settings(&point->job.shot.settings, settings, diag);
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES && !status; i++)
        status = measure_floor(bench, point, &settings[i], &floors[i], diag);
    for (int n = 0; n < NEPH_SWEEP_NUMBERS && !status; n++) {
        const double own = floors[0].numbers[n].value, other = floors[1].numbers[n].value;
        point->floors[n] = isnan(own) || isnan(other) ? NAN : fmin(own, other);
    }
    return is_point_error(status) ? NEPH_OK : status;
}

/* --- single frames -------------------------------------------------------------------------- */

enum neph_status neph_sweep_point_render(const struct neph_sweep_context *bench,
                                         struct neph_sweep_point *point, int round,
                                         struct neph_sweep_value *error, struct neph_cost *cost,
                                         struct neph_diag *diag)
{
    struct neph_job job = point->job;
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    job.repeat = round;
    job.shot.frame = bench->frame;
    if (job.engine->stochastic)
        job.shot.seed = neph_sweep_seed(bench->seed, round);
    enum neph_status status = neph_job_run(&job, bench->store, &result, diag);
    if (!status && result.outcome != NEPH_OUTCOME_RENDERED)
        snprintf(point->missing, sizeof(point->missing), "%s", result.reason);
    if (!status && result.outcome == NEPH_OUTCOME_RENDERED) {
        *cost = result.cost;
        status = neph_sweep_truth_error(bench->truth, result.frame_path, error, diag);
        if (!status)
            status = neph_sweep_point_count(result.frame_path, point, diag);
    }
    neph_job_result_finish(&result);
    return status;
}

enum neph_status neph_sweep_point_measure(struct neph_sweep_context *bench,
                                          struct neph_sweep_point *point, struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    struct neph_cost cost;
    enum neph_status status;
    if (neph_sweep_is_sequence(point))
        status = measure_sequence(bench, point, &why);
    else
        status = neph_sweep_point_render(bench, point, 0, &point->numbers[NEPH_SWEEP_ERROR], &cost,
                                         &why);
    if (!status && neph_sweep_has_lag(point->series, point->place))
        status = measure_lag(bench, point, &why);
    if (!status)
        status = measure_floors(bench, point, &why);
    point->at_floor = point->numbers[NEPH_SWEEP_ERROR].value < 2.0 * bench->truth->noise;
    if (is_point_error(status)) {
        snprintf(point->missing, sizeof(point->missing), "%s", why.message);
        return NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    return status;
}

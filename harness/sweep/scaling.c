/* SPDX-License-Identifier: MIT
 *
 * Cost over problem size: points of each axis, counting, timing, exponents.
 */
#include "harness/sweep/scaling.h"

#include "base/exr.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/sweep/candidates.h"
#include "harness/sweep/point.h"
#include "harness/sweep/scaled.h"
#include "scenes/relit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when an axis is added, as the table of axes needs a row for it. */
_Static_assert(NEPH_SCALING_AXES == 5, "a new kind");

/* Fixed costs make small problems relatively more expensive, so times may grow more slowly than
 * work. */
const struct neph_scaling_axis neph_scaling_axes[NEPH_SCALING_AXES] = {
    [NEPH_SCALING_PIXELS] =
        {"pixels",
         "pixels of a frame",
         {0.25, 0.375, 0.5, 0.75, 1.0},
         {1, 1},
         {0, 1},
         "every pixel or tile has its own ray; fixed costs of a frame are the same for all sizes"},
    [NEPH_SCALING_STEPS] =
        {"steps",
         "steps of a ray",
         {8, 16, 32, 64, 128},
         {1, 1},
         {0, 1},
         "every step evaluates the density once; fixed costs of a ray are the same for all"},
    [NEPH_SCALING_VOXELS] =
        {"voxels",
         "voxels of the media",
         {24, 32, 48, 64, 96, 128},
         {0, 0},
         {0, 1.0 / 3.0},
         "a step reads the same few voxels in a grid of any size; caches cover a smaller part of a "
         "large grid, at worst in proportion to the voxels along a ray"},
    [NEPH_SCALING_DEPTH] = {"density",
                            "density, relative to the scene's",
                            {0.25, 0.5, 1, 2, 4},
                            {-1, 0},
                            {-1, 0},
                            "a denser medium needs no further evaluations; rays that end at a low "
                            "transmittance end earlier"},
    [NEPH_SCALING_FRAMES] = {"pictures",
                             "frames in a row",
                             {4, 8, 16, 32, 64},
                             {1, 1},
                             {1, 1},
                             "a history costs the same in every frame"},
};

enum {
    STEPS = 32,
    ROUNDS = 3,
    POINTS_MAX = NEPH_SCALING_AXES * NEPH_SCALING_VALUES_MAX * NEPH_SCALING_SERIES
};
enum { KIND_POINT, KIND_PICTURES, KIND_ROUND }; /* of progress steps */

int neph_scaling_value_count(const struct neph_scaling_axis *axis)
{
    int count = 0;
    while (count < NEPH_SCALING_VALUES_MAX && axis->values[count] > 0.0)
        count++;
    return count;
}

/* The scene at a value of an axis, shared by all series. */
struct scene_at {
    struct neph_scene *made; /* owned; NULL: the unchanged scene */
    double x;
    char missing[256];
};

/* A point of a line, and the index of the rendered point with its result. */
struct point_use {
    struct neph_scaling_point *into;
    int point;
};

struct work {
    const struct neph_scaling_params *params;
    struct neph_store *store;
    struct neph_scene *scene;
    struct neph_sweep_plan plan; /* has the series of the scaling */
    struct neph_engine_info infos[NEPH_SCALING_SERIES];
    struct scene_at scenes[NEPH_SCALING_AXES][NEPH_SCALING_VALUES_MAX];
    struct neph_sweep_point *points;               /* points that are rendered and timed */
    char keys[POINTS_MAX + 1][NEPH_HASH_HEX_SIZE]; /* store keys of their jobs; one more for the
                                                      search */
    int point_count;
    struct point_use uses[POINTS_MAX];
    int use_count;
    struct neph_progress progress;
    struct neph_scaling *scaling;
};

/* --- scenes --------------------------------------------------------------------------------- */

static enum neph_status make_scene(struct work *work, enum neph_scaling_axis_id axis, double value,
                                   struct scene_at *at, struct neph_diag *diag)
{
    struct neph_relight denser = {NAN, NAN, NAN, NAN, value, 0.0};
    struct neph_diag why = {.line = 0};
    enum neph_status status = NEPH_OK;
    at->x = value;
    if (axis == NEPH_SCALING_VOXELS)
        status = neph_scaled_make(work->scene, (int)value, &at->made, &at->x, &why);
    else if (axis == NEPH_SCALING_DEPTH)
        status = neph_scene_relit(work->scene, &denser, work->scene->scattering, &at->made, &why);
    if (status == NEPH_ERR_UNSUPPORTED || status == NEPH_ERR_INPUT) {
        snprintf(at->missing, sizeof(at->missing), "%s", why.message);
        return NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    return status;
}

static void finish_scenes(struct work *work)
{
    for (int axis = 0; axis < NEPH_SCALING_AXES; axis++)
        for (int i = 0; i < NEPH_SCALING_VALUES_MAX; i++)
            if (axis == NEPH_SCALING_VOXELS)
                neph_scaled_destroy(work->scenes[axis][i].made);
            else
                neph_scene_destroy(work->scenes[axis][i].made);
}

/* --- points --------------------------------------------------------------------------------- */

static enum neph_status make_job(struct work *work, int series, const struct neph_scene *scene,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_sweep_series *of = &work->plan.series[series];
    const enum neph_scattering scattering = work->scene->scattering;
    *job = (struct neph_job){.engine = neph_sweep_engine(&work->plan, of, scattering),
                             .info = &work->infos[series],
                             .shot = {.scene = scene,
                                      .width_px = work->params->width_px,
                                      .height_px = work->params->height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = (uint64_t)work->params->seed,
                                      .device = work->params->device}};
    enum neph_status status = neph_sweep_settings(&work->plan, of, 0, scattering,
                                                  &job->shot.settings, diag);
    char steps[24];
    if (!status)
        neph_settings_adapt_to_scene(job->engine, scene, &job->shot.settings);
    snprintf(steps, sizeof(steps), "steps=%d", STEPS);
    return status ? status : neph_settings_set(job->engine, &job->shot.settings, steps, diag);
}

static enum neph_status set_value(enum neph_scaling_axis_id axis, double value,
                                  struct neph_job *job, double *x, struct neph_diag *diag)
{
    struct neph_shot *shot = &job->shot;
    char steps[24];
    snprintf(steps, sizeof(steps), "steps=%.0f", value);
    if (axis == NEPH_SCALING_STEPS)
        return neph_settings_set(job->engine, &shot->settings, steps, diag);
    if (axis == NEPH_SCALING_PIXELS) {
        shot->width_px = (int)fmax(4.0, value * shot->width_px);
        shot->height_px = (int)fmax(4.0, value * shot->height_px);
        *x = (double)shot->width_px * shot->height_px;
    }
    return NEPH_OK;
}

/* Finds or adds a point: a point that lies on two lines is rendered and timed once. */
static enum neph_status find_or_add_point(struct work *work, const struct neph_sweep_series *series,
                                          const struct neph_job *job, int *index,
                                          struct neph_diag *diag)
{
    char(*keys)[NEPH_HASH_HEX_SIZE] = work->keys;
    const int count = work->point_count;
    const enum neph_status status = neph_job_key(job, keys[count], diag);
    for (*index = 0; !status && strcmp(keys[*index], keys[count]) != 0;)
        (*index)++;
    if (status || *index < count)
        return status;
    work->points[work->point_count++] = (struct neph_sweep_point){
        .series = series, .job = *job, .time = {NAN, NAN, NAN}, .evaluations = NAN};
    return NEPH_OK;
}

static enum neph_status add_point(struct work *work, struct neph_scaling_line *line, int place,
                                  struct neph_diag *diag)
{
    const struct neph_scaling_axis *axis = &neph_scaling_axes[line->axis];
    const struct scene_at *at = &work->scenes[line->axis][place];
    const struct neph_sweep_series *series = &work->plan.series[line->series];
    double x = at->x;
    struct neph_job job;
    snprintf(line->missing, sizeof(line->missing), "%s", at->missing);
    if (line->missing[0])
        return NEPH_OK;
    enum neph_status status = make_job(work, line->series, at->made ? at->made : work->scene, &job,
                                       diag);
    if (!status)
        status = set_value(line->axis, axis->values[place], &job, &x, diag);
    if (status || !job.engine->can_render(job.shot.scene, &job.shot.settings, line->missing,
                                          sizeof(line->missing)))
        return status;
    struct point_use *point_use = &work->uses[work->use_count++];
    point_use->into = &line->points[line->count++];
    *point_use->into = (struct neph_scaling_point){x, NAN, {NAN, NAN, NAN}};
    return find_or_add_point(work, series, &job, &point_use->point, diag);
}

static enum neph_status add_lines(struct work *work, struct neph_diag *diag)
{
    struct neph_scaling *scaling = work->scaling;
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < NEPH_SCALING_AXES; axis++)
        for (int series = 0; series < NEPH_SCALING_SERIES; series++) {
            struct neph_scaling_line *line = &scaling->lines[scaling->line_count++];
            const int count = neph_scaling_value_count(&neph_scaling_axes[axis]);
            *line = (struct neph_scaling_line){.axis = (enum neph_scaling_axis_id)axis,
                                               .series = series};
            for (int i = 0; i < count && axis != NEPH_SCALING_FRAMES && !status; i++)
                if (!line->missing[0])
                    status = add_point(work, line, i, diag);
        }
    return status;
}

/* --- counting ------------------------------------------------------------------------------- */

static enum neph_status count_point(struct work *work, struct neph_sweep_point *point,
                                    struct neph_diag *diag)
{
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    enum neph_status status = neph_job_run(&point->job, work->store, &result, diag);
    if (!status)
        status = neph_outcome_check(result.outcome, result.reason, diag);
    if (!status)
        status = neph_sweep_point_count(result.frame_path, point, diag);
    neph_job_result_finish(&result);
    return status;
}

/* Renders frames in a row and records the accumulated cost at the 4th, the 8th, ... frame. */
static enum neph_status count_frames_in_row(struct work *work, struct neph_scaling_line *line,
                                            struct neph_diag *diag)
{
    const struct neph_scaling_axis *axis = &neph_scaling_axes[NEPH_SCALING_FRAMES];
    const int kinds = neph_scaling_value_count(axis), most = (int)axis->values[kinds - 1];
    struct neph_scaling_point spent = {0.0, 0.0, {0.0, NAN, NAN}};
    struct neph_job job;
    enum neph_status status = make_job(work, line->series, work->scene, &job, diag);
    if (!status)
        status = neph_job_open(&job, diag);
    for (int i = 0; i < most && !status; i++) {
        struct neph_image *frame = NULL;
        struct neph_cost cost;
        job.shot.frame = neph_flight_frame(i, work->scene->frame_count);
        status = neph_job_render(&job, &frame, &cost, diag);
        if (status)
            break;
        spent.x = i + 1;
        spent.evaluations += neph_sweep_evaluations(&job, frame);
        spent.time.median += cost.render_s;
        neph_image_destroy(frame);
        if (spent.x == axis->values[line->count])
            line->points[line->count++] = spent;
    }
    neph_job_close(&job);
    for (int i = 0; i < line->count && work->params->untimed; i++)
        line->points[i].time.median = NAN;
    return status;
}

/* Renders points so that their frames are in the store. In worker 0, the main process, this reads
 * all points. */
static enum neph_status count_points(struct neph_worker *worker, void *context,
                                     struct neph_diag *diag)
{
    struct work *work = context;
    enum neph_status status = NEPH_OK;
    for (int i; !status && (i = neph_worker_take_job(worker)) < work->point_count;) {
        status = count_point(work, &work->points[i], diag);
        if (worker->index == 0)
            neph_progress_tick(&work->progress, "evaluations");
    }
    return status;
}

static enum neph_status count_all(struct work *work, struct neph_diag *diag)
{
    struct neph_scaling *scaling = work->scaling;
    work->progress.kind = KIND_POINT;
    enum neph_status status = neph_pool_run(work->params->jobs, work->params->device, count_points,
                                            NULL, work, diag);
    for (int i = 0; i < scaling->line_count && !status; i++)
        if (scaling->lines[i].axis == NEPH_SCALING_FRAMES) {
            work->progress.kind = KIND_PICTURES;
            status = count_frames_in_row(work, &scaling->lines[i], diag);
            neph_progress_tick(&work->progress, "frames in a row");
        }
    return status;
}

static enum neph_status time_all(struct work *work, struct neph_diag *diag)
{
    struct neph_sweep_context bench = {.plan = &work->plan,
                                       .store = work->store,
                                       .progress = &work->progress,
                                       .times = work->params->times,
                                       .remeasures_times = work->params->remeasures_times,
                                       .seed = (uint64_t)work->params->seed};
    work->progress.kind = KIND_ROUND;
    const enum neph_status status = neph_sweep_time(&bench, work->points, work->point_count, diag);
    neph_sweep_context_finish(&bench);
    return status;
}

static void fill_lines(struct work *work)
{
    for (int i = 0; i < work->use_count; i++) {
        const struct neph_sweep_point *point = &work->points[work->uses[i].point];
        const struct neph_shot *shot = &point->job.shot;
        work->uses[i].into->evaluations = rint(point->evaluations * shot->width_px *
                                               shot->height_px);
        work->uses[i].into->time = point->time;
    }
}

/* --- judgement, plan, run ------------------------------------------------------------------- */

void neph_scaling_judge(struct neph_scaling *scaling)
{
    for (int i = 0; i < scaling->line_count; i++) {
        struct neph_scaling_line *line = &scaling->lines[i];
        const struct neph_scaling_axis *axis = &neph_scaling_axes[line->axis];
        double x[NEPH_SCALING_VALUES_MAX], work[NEPH_SCALING_VALUES_MAX],
            time[NEPH_SCALING_VALUES_MAX];
        for (int k = 0; k < line->count; k++) {
            x[k] = line->points[k].x;
            work[k] = line->points[k].evaluations;
            time[k] = line->points[k].time.median;
        }
        line->work = neph_exponent_fit(x, work, line->count);
        line->time = neph_exponent_fit(x, time, line->count);
        line->work_verdict = neph_exponent_judge(&line->work, axis->work);
        line->time_verdict = neph_exponent_judge(&line->time, axis->time);
    }
}

static enum neph_status make_plan(struct work *work, struct neph_diag *diag)
{
    const struct neph_scaling_params *params = work->params;
    struct neph_sweep_plan *plan = &work->plan;
    const struct neph_sweep_series march = {.name = "march", .engine = "march", .scattering = -1};
    const struct neph_sweep_series realtime = {.name = params->preset,
                                               .engine = "realtime",
                                               .preset = params->preset,
                                               .flicker = true,
                                               .scattering = -1};
    *plan = (struct neph_sweep_plan){
        .title = "scaling", .light = "octaves", .round_count = ROUNDS, .seed_count = 1};
    enum neph_status status = neph_candidate_add_series(plan, &march, NULL, diag);
    if (!status)
        status = neph_candidate_add_series(plan, &realtime, NULL, diag);
    for (int i = 0; i < plan->series_count && !status; i++) {
        struct neph_job job;
        struct neph_engine_info *info = &work->infos[i];
        status = make_job(work, i, work->scene, &job, diag);
        if (status)
            break;
        neph_engine_probe(job.engine, work->params->device, info);
        if (!info->available)
            status = neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s: %s", job.engine->name,
                               info->missing);
        snprintf(work->scaling->series[i], sizeof(work->scaling->series[i]), "%s",
                 plan->series[i].name);
        snprintf(work->scaling->device, sizeof(work->scaling->device), "%s", info->device);
    }
    return status;
}

static enum neph_status make_scenes(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int axis = 0; axis < NEPH_SCALING_AXES; axis++)
        for (int i = 0; i < neph_scaling_value_count(&neph_scaling_axes[axis]) && !status; i++)
            status = make_scene(work, (enum neph_scaling_axis_id)axis,
                                neph_scaling_axes[axis].values[i], &work->scenes[axis][i], diag);
    return status;
}

static enum neph_status prepare(struct work *work, struct neph_diag *diag)
{
    enum neph_status status = neph_data_load_scene(work->params->scene, &work->scene, diag);
    if (!status)
        status = make_plan(work, diag);
    if (!status)
        status = make_scenes(work, diag);
    work->points = calloc(POINTS_MAX, sizeof(*work->points));
    if (!status && !work->points)
        status = neph_fail_memory(diag);
    if (status)
        return status;
    snprintf(work->scaling->scene, sizeof(work->scaling->scene), "%s", work->scene->name);
    snprintf(work->scaling->scene_hash, sizeof(work->scaling->scene_hash), "%s", work->scene->hash);
    work->scaling->width_px = work->params->width_px;
    work->scaling->height_px = work->params->height_px;
    work->scaling->has_closed_form = neph_candidate_has_closed_form(work->scene);
    return add_lines(work, diag);
}

enum neph_status neph_scaling_run(const struct neph_scaling_params *params,
                                  struct neph_store *store, struct neph_scaling *scaling,
                                  struct neph_diag *diag)
{
    struct work work = {.params = params,
                        .store = store,
                        .scaling = scaling,
                        .progress = neph_progress_start(params->quiet, 0)};
    *scaling = (struct neph_scaling){.line_count = 0};
    enum neph_status status = prepare(&work, diag);
    neph_progress_expect(&work.progress, KIND_POINT, work.point_count, 1.0);
    neph_progress_expect(&work.progress, KIND_PICTURES, NEPH_SCALING_SERIES, 20.0);
    if (!params->untimed)
        neph_progress_expect(&work.progress, KIND_ROUND, ROUNDS, 20.0);
    if (!status)
        status = count_all(&work, diag);
    if (!status && !params->untimed)
        status = time_all(&work, diag);
    fill_lines(&work);
    if (!status)
        neph_scaling_judge(scaling);
    neph_progress_end(&work.progress);
    finish_scenes(&work);
    neph_sweep_plan_finish(&work.plan);
    neph_scene_destroy(work.scene);
    free(work.points);
    return status;
}

enum neph_status neph_scaling_load(const char *path, json_t **document, struct neph_diag *diag)
{
    json_error_t error;
    json_t *loaded = json_load_file(path, 0, &error);
    if (!loaded)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s': %s", path, error.text);
    if (strcmp(neph_json_text(loaded, "format"), "neph-scaling-1") != 0) {
        json_decref(loaded);
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is no file of `neph study scaling`", path);
    }
    *document = loaded;
    return NEPH_OK;
}

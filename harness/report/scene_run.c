/* SPDX-License-Identifier: MIT */
#include "harness/report/scene_run.h"

#include "base/clock.h"
#include "base/doubt.h"
#include "base/exr.h"
#include "harness/engines/engines.h"
#include "harness/engines/non_physical.h"
#include "harness/report/scene_layers.h"
#include "harness/report/step_depth.h"
#include "harness/run/budget.h"
#include "harness/run/noise.h"
#include "harness/run/seed.h"
#include "harness/study/studies.h"
#include "scenes/display.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_SHOWN_COUNT == 2, "a new kind");

/* Factor on the budget of a second seed. Its first frame was within the budget, so the second one
 * normally is, too, unless the machine is busy. Giving it up would exclude the engine from the
 * attribution. */
enum { SECOND_SEED_PATIENCE = 4 };

/* Kinds of progress steps, for the estimate of the remaining time: a frame and a second seed by
 * engine. */
enum { KIND_FRAME = 0, KIND_SECOND_SEED = NEPH_FIELD_MAX };

static bool has_second_seed(const struct neph_engine *engine)
{
    return engine->stochastic;
}

static bool is_listed(const struct neph_engine *engine, const char *const *names)
{
    for (; names && *names; names++)
        if (neph_engine_is_kind(engine, *names))
            return true;
    return false;
}

/* True when an engine of the run renders the current scene. */
static bool takes_part(const struct neph_scene_run *run, int index)
{
    const struct neph_scene_plan *plan = run->plan;
    return !plan || !plan->engines || is_listed(run->field->engines[index], plan->engines);
}

int neph_scene_run_engine_count(const struct neph_scene_run *run)
{
    int count = 0;
    for (int i = 0; i < run->field->count; i++)
        count += takes_part(run, i);
    return count;
}

void neph_scene_run_expect(const struct neph_scene_run *run, int count)
{
    for (int i = 0; i < run->field->count; i++) {
        const struct neph_engine *engine = run->field->engines[i];
        if (!takes_part(run, i))
            continue;
        const double guess_s = run->field->infos[i].available ? engine->typical_s : 0.0;
        neph_progress_expect(run->progress, KIND_FRAME + i, count, guess_s);
        if (has_second_seed(engine))
            neph_progress_expect(run->progress, KIND_SECOND_SEED + i, count, guess_s);
    }
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status apply_settings(struct neph_job *job, const char *const *texts, int count,
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        const char *assignment = neph_settings_match_engine(job->engine, texts[i]);
        if (assignment)
            status = neph_settings_set(job->engine, &job->shot.settings, assignment, diag);
    }
    return status;
}

/* Apply size, layers and settings of the current scene; the user's settings override them. */
static enum neph_status apply_plan(const struct neph_scene_run *run, struct neph_job *job,
                                   struct neph_diag *diag)
{
    const struct neph_scene_plan *plan = run->plan;
    const struct neph_validate_params *params = run->params;
    int count = 0;
    if (plan && plan->width_px > 0) {
        job->shot.width_px = plan->width_px;
        job->shot.height_px = plan->height_px;
    }
    if (plan && is_listed(job->engine, plan->light_only))
        job->shot.layers = NEPH_LAYER_RADIANCE;
    while (plan && plan->settings && plan->settings[count])
        count++;
    if (count == 0)
        return NEPH_OK;
    const enum neph_status status = apply_settings(job, plan->settings, count, diag);
    return status ? status : apply_settings(job, params->settings, params->setting_count, diag);
}

/* Make a job. `second` selects the second of the two frames that an engine with random paths
 * renders for each seed of the run. */
static enum neph_status make_job(const struct neph_scene_run *run, int index,
                                 const struct neph_scene *scene, bool second, struct neph_job *job,
                                 struct neph_diag *diag)
{
    const struct neph_engine *engine = run->field->engines[index];
    const int seed = 1 + second + (neph_engine_is_random(engine) ? 2 * (run->params->seed - 1) : 0);
    *job = (struct neph_job){
        .engine = engine,
        .info = &run->field->infos[index],
        .shot = {.scene = scene,
                 .settings = run->field->settings[index],
                 .width_px = run->params->width_px,
                 .height_px = run->params->height_px,
                 .layers = NEPH_LAYERS_ALL,
                 .seed = neph_seed_for_scene(scene, seed),
                 .device = run->params->device},
    };
    return apply_plan(run, job, diag);
}

/* True when the user has set the step. */
static bool has_depth_step(const struct neph_job *job)
{
    const struct neph_settings standard = neph_settings_default(job->engine);
    const char *step = job->engine->step.option;
    const double chosen = neph_setting(job->engine, &job->shot.settings, step);
    const double usual = neph_setting(job->engine, &standard, step);
    return chosen != usual && !(isnan(chosen) && isnan(usual));
}

/* Choose the step of an external renderer by a step study: one of the studies that come with neph,
 * or a new one. `*chosen` is false without a study; `*is_late` is true when the budget ended it. */
static enum neph_status choose_step(const struct neph_scene_run *run, struct neph_job *job,
                                    struct neph_study *study, bool *chosen, bool *is_late,
                                    struct neph_diag *diag)
{
    *chosen = *is_late = false;
    if (job->engine->rung != NEPH_LEVEL_EXTERNAL || !job->info->available ||
        !neph_study_applies(job->engine, job->shot.scene) ||
        !neph_engine_has_steps(job->engine, job->info, &job->shot.settings) || has_depth_step(job))
        return NEPH_OK;
    enum neph_status status = neph_studies_find(job, study, chosen, diag);
    if (!status && !*chosen) {
        enum neph_outcome outcome;
        char reason[1600]; /* unused: the frame reports it */
        struct neph_job limited = *job;
        limited.shot.time_limit_s = run->params->budget_s;
        status = neph_studies_make(&limited, run->store, study, &outcome, reason, diag);
        *chosen = !status && outcome == NEPH_OUTCOME_RENDERED;
        *is_late = outcome == NEPH_OUTCOME_TIMEOUT;
    }
    if (*chosen)
        neph_study_apply(study, job->engine, &job->shot.settings);
    return status;
}

/* Warn of steps with a large optical depth, which leave no visible artefact. */
static void warn_about_steps(const struct neph_job *job, double depth)
{
    char *warning = neph_step_depth_warning(depth, job->engine);
    if (warning)
        fprintf(stderr, "warning: %s: %s\n", job->shot.scene->name, warning);
    free(warning);
}

/* A progress step: one frame. */
struct step {
    char what[256];
    int kind;
    double start_s;
};

static struct step begin_step(const struct neph_scene_run *run, const struct neph_job *job,
                              int kind)
{
    struct step step = {.kind = kind, .start_s = neph_wall_s()};
    snprintf(step.what, sizeof(step.what), "%s with %s%s", job->shot.scene->name, job->engine->name,
             kind >= KIND_SECOND_SEED ? ", second seed" : "");
    run->progress->kind = kind;
    neph_progress_begin(run->progress, step.what);
    return step;
}

static uint64_t step_bit(const struct step *step)
{
    return UINT64_C(1) << step->kind;
}

/* End a step. A step that a worker has already reported is not counted again. */
static void end_step(const struct neph_scene_run *run, const struct step *step,
                     const struct neph_job_result *result)
{
    const double seconds = neph_wall_s() - step->start_s;
    const bool is_counted = result->reused && (run->told.steps & step_bit(step));
    if (run->tell && result->frame_path)
        run->tell(run, step->what, result->reused, seconds);
    if (!is_counted)
        neph_progress_step(run->progress, step->what,
                           result->reused ? "reused" : neph_outcome_name(result->outcome), seconds);
}

/* Render; external renderers within their budget. */
static enum neph_status render(const struct neph_scene_run *run, struct neph_job *job,
                               struct neph_job_result *result, struct neph_diag *diag)
{
    if (job->engine->rung != NEPH_LEVEL_EXTERNAL)
        return neph_job_run(job, run->store, result, diag);
    return run->tell ? neph_budget_try(job, run->params->budget_s, run->store, result, diag)
                     : neph_budget_run(job, run->params->budget_s, run->store, result, diag);
}

/* The note of a frame: missing samples, or the non-physical fog model that its settings select. */
static const char *format_frame_note(const struct neph_scene_run *run, const struct neph_job *job,
                                     const struct neph_job_result *result)
{
    const char *look = job->engine->look ? NULL
                                         : neph_fog_model_note(job->engine, &job->shot.settings);
    return neph_arena_copy_text(run->arena, look && !result->note[0] ? look : result->note);
}

static void take_result(const struct neph_scene_run *run, const struct neph_job *job,
                        const struct neph_job_result *result, struct neph_frame_result *frame)
{
    *frame = (struct neph_frame_result){
        .engine = job->engine,
        .outcome = result->outcome,
        .reason = neph_arena_copy_text(run->arena, result->reason),
        .note = format_frame_note(run, job, result),
        .is_look = neph_is_non_physical(job->engine, &job->shot.settings),
        .settings = neph_arena_copy_text(run->arena, result->settings),
        .cost = result->cost,
        .job = *job,
        .noise = NAN,
        .noise_doubt = NAN,
        .seed = job->shot.seed,
        .step_optical_depth = neph_step_depth(&job->shot, job->engine),
        .path = neph_arena_copy_text(run->arena, result->frame_path),
    };
    frame->job.shot.scene = NULL; /* the scene is freed before the result */
}

/* `*chosen` gets the settings, for the second seed. */
static enum neph_status run_frame(const struct neph_scene_run *run, int index,
                                  const struct neph_scene *scene, struct neph_frame_result *frame,
                                  struct neph_settings *chosen, struct neph_diag *diag)
{
    struct neph_job job;
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    struct neph_study study;
    bool is_studied = false, is_late = false;
    enum neph_status status = make_job(run, index, scene, false, &job, diag);
    const struct step step = begin_step(run, &job, KIND_FRAME + index);
    if (!status)
        status = choose_step(run, &job, &study, &is_studied, &is_late, diag);
    if (run->tell && is_late)
        result.outcome = NEPH_OUTCOME_TIMEOUT;
    else if (!status)
        status = render(run, &job, &result, diag);
    *chosen = job.shot.settings;
    if (!status) {
        take_result(run, &job, &result, frame);
        frame->reused = result.reused && !(run->told.made & step_bit(&step));
        if (is_studied)
            frame->study = neph_arena_copy(run->arena, &study, sizeof(study));
        if (!run->tell)
            warn_about_steps(&job, frame->step_optical_depth);
        end_step(run, &step, &result);
    }
    neph_job_result_finish(&result);
    return status;
}

static enum neph_status run_second_seed(const struct neph_scene_run *run, int index,
                                        const struct neph_scene *scene,
                                        const struct neph_settings *chosen,
                                        struct neph_frame_result *frame, struct neph_diag *diag)
{
    struct neph_job job;
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    enum neph_status status = make_job(run, index, scene, true, &job, diag);
    job.shot.settings = *chosen;
    job.shot.time_limit_s = SECOND_SEED_PATIENCE * run->params->budget_s;
    const struct step step = begin_step(run, &job, KIND_SECOND_SEED + index);
    if (!status)
        status = neph_job_run(&job, run->store, &result, diag);
    if (!status) {
        frame->second_path = neph_arena_copy_text(run->arena, result.frame_path);
        frame->second_cost = result.cost;
        if (run->tell && result.outcome == NEPH_OUTCOME_TIMEOUT)
            frame->outcome = NEPH_OUTCOME_TIMEOUT; /* the worker reports it as late */
        end_step(run, &step, &result);
    }
    neph_job_result_finish(&result);
    return status;
}

/* Data of a frame for its second seed. */
struct frame_job {
    int index; /* of the engine in `field` */
    struct neph_settings chosen;
};

/* Render a second seed of every stochastic engine when at least three engines have a frame:
 * attribution needs three. */
static enum neph_status run_second_seeds(const struct neph_scene_run *run,
                                         const struct neph_scene *scene,
                                         const struct frame_job *jobs,
                                         struct neph_scene_result *result, struct neph_diag *diag)
{
    int rendered = 0;
    for (int f = 0; f < result->frame_count; f++)
        rendered += result->frames[f].path != NULL;
    enum neph_status status = NEPH_OK;
    for (int f = 0; f < result->frame_count && !status; f++) {
        struct neph_frame_result *frame = &result->frames[f];
        if (!has_second_seed(frame->engine))
            continue;
        if (rendered >= 3 && frame->path)
            status = run_second_seed(run, jobs[f].index, scene, &jobs[f].chosen, frame, diag);
        else
            neph_progress_expect(run->progress, KIND_SECOND_SEED + jobs[f].index, -1, 0.0);
    }
    return status;
}

/* ---- measurements ---------------------------------------------------------------------------- */

/* Compare all pairs of physical engines. A real-time method is included if the engine of its
 * lighting model is physical. */
static enum neph_status attribute(const struct neph_scene_run *run,
                                  struct neph_scene_result *result, struct neph_diag *diag)
{
    struct neph_peer peers[NEPH_FIELD_MAX];
    int count = 0;
    for (int f = 0; f < result->frame_count; f++) {
        const struct neph_frame_result *frame = &result->frames[f];
        if (frame->path && !frame->is_look)
            peers[count++] = (struct neph_peer){frame->engine->name, frame->path,
                                                frame->second_path,
                                                frame->engine->shortcut_of != NULL};
    }
    return neph_attribute(peers, count, run->arena, &result->attribution, diag);
}

/* The index of the reference: the frame of the highest reference level (exact or a path tracer);
 * -1: none. */
static int find_truth(const struct neph_scene_result *result)
{
    for (int f = 0; f < result->frame_count; f++)
        if (result->frames[f].path && result->frames[f].engine->rung <= NEPH_LEVEL_TRACER)
            return f;
    return -1;
}

/* Measure the noise of a frame: from its two seeds, or from its own variance channel. */
static enum neph_status measure_noise(const struct neph_image *image,
                                      struct neph_frame_result *frame, struct neph_diag *diag)
{
    struct neph_image *second = NULL;
    enum neph_status status = NEPH_OK;
    if (frame->second_path)
        status = neph_exr_read(frame->second_path, &second, diag);
    if (second)
        frame->noise = neph_noise_from_two_seeds(image, second);
    else if (frame->engine->stochastic)
        frame->noise = neph_noise_from_variance(image);
    frame->noise_doubt = neph_doubt_read(image);
    neph_image_destroy(second);
    return status;
}

/* Read the second frame of an engine: the first frame for a deterministic engine, NULL when it was
 * not rendered. The caller destroys it unless it is `first`. */
static enum neph_status read_second(const struct neph_frame_result *frame, struct neph_image *first,
                                    struct neph_image **second, struct neph_diag *diag)
{
    *second = frame->engine->stochastic ? NULL : first;
    return frame->second_path ? neph_exr_read(frame->second_path, second, diag) : NEPH_OK;
}

/* The reference of a scene. */
struct truth {
    struct neph_image *image, *second; /* NULL: none */
};

static enum neph_status find_parts(const struct truth *truth, struct neph_image *image,
                                   struct neph_frame_result *frame, struct neph_diag *diag)
{
    struct neph_image *second = NULL;
    enum neph_status status = read_second(frame, image, &second, diag);
    const struct neph_error_frames frames = {truth->image, truth->second, image, second};
    if (!status)
        status = neph_error_parts(&frames, &frame->error_parts, diag);
    if (second != image)
        neph_image_destroy(second);
    return status;
}

/* Measure one rendered frame, against the reference if there is one. */
static enum neph_status measure_frame(const struct neph_scene_run *run, const struct truth *truth,
                                      const struct neph_viewing *viewing,
                                      struct neph_frame_result *frame, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    enum neph_status status = frame->path ? neph_exr_read(frame->path, &image, diag) : NEPH_OK;
    if (!image)
        return status;
    struct neph_bakes_summary bakes;
    if (neph_bakes_from_frame(image, &bakes))
        frame->bakes = neph_arena_copy(run->arena, &bakes, sizeof(bakes));
    status = measure_noise(image, frame, diag);
    if (!status)
        status = neph_measure_validity(image, &frame->measurements, diag);
    if (!status && truth)
        status = neph_measure(truth->image, image, NULL, viewing, &frame->measurements, diag);
    if (!status && truth)
        status = find_parts(truth, image, frame, diag);
    neph_image_destroy(image);
    return status;
}

static enum neph_status measure_all(const struct neph_scene_run *run,
                                    const struct neph_scene *scene,
                                    struct neph_scene_result *result, struct neph_diag *diag)
{
    struct truth truth = {NULL, NULL};
    enum neph_status status = NEPH_OK;
    if (result->truth >= 0)
        status = neph_exr_read(result->frames[result->truth].path, &truth.image, diag);
    if (truth.image)
        status = neph_scene_layers_add(scene, 0, truth.image, diag);
    if (!status && truth.image)
        status = read_second(&result->frames[result->truth], truth.image, &truth.second, diag);
    for (int f = 0; f < result->frame_count && !status; f++)
        status = measure_frame(run, f == result->truth || !truth.image ? NULL : &truth,
                               &result->viewing, &result->frames[f], diag);
    if (truth.second != truth.image)
        neph_image_destroy(truth.second);
    neph_image_destroy(truth.image);
    return status;
}

/* Colour scales of difference maps are constant, so that runs are comparable: 2 % of the display's
 * white for radiance, 0.002 for transmittance, a few times the limits of the catalogue's gates. */
static void describe(const struct neph_scene_run *run, const struct neph_scene *scene,
                     struct neph_scene_result *result)
{
    const bool has_size = run->plan && run->plan->width_px > 0;
    result->name = neph_arena_copy_text(run->arena, scene->name);
    result->title = neph_arena_copy_text(run->arena, scene->title);
    result->physics = neph_arena_copy_text(run->arena, scene->description);
    result->hash = neph_arena_copy_text(run->arena, scene->hash);
    result->file = neph_arena_copy_text(run->arena, scene->path);
    result->width_px = has_size ? run->plan->width_px : run->params->width_px;
    result->height_px = has_size ? run->plan->height_px : run->params->height_px;
    result->viewing = NEPH_VIEWING_DEFAULTS;
    result->viewing.exposure_ev = neph_scene_display(scene)->exposure_ev;
    result->difference_scales[NEPH_SHOWN_RADIANCE] = 0.02 *
                                                     exp2(-neph_scene_display(scene)->exposure_ev);
    result->difference_scales[NEPH_SHOWN_TRANSMITTANCE] = 0.002;
}

/* With --only-engine an added reference engine is skipped once the scene has a reference. */
static bool is_left_out(const struct neph_scene_run *run, int index,
                        const struct neph_scene_result *result)
{
    return run->field->is_reference_only[index] && find_truth(result) >= 0;
}

static void add_absent_frame(const struct neph_scene_run *run, int index,
                             struct neph_scene_result *result)
{
    neph_progress_expect(run->progress, KIND_FRAME + index, -1, 0.0);
    if (has_second_seed(run->field->engines[index]))
        neph_progress_expect(run->progress, KIND_SECOND_SEED + index, -1, 0.0);
    result->left_out_count++;
}

static enum neph_status render_all(const struct neph_scene_run *run, const struct neph_scene *scene,
                                   struct neph_scene_result *result, struct neph_diag *diag)
{
    struct frame_job jobs[NEPH_FIELD_MAX];
    const size_t count = (size_t)run->field->count;
    result->frames = neph_arena_allocate(run->arena, count, sizeof(*result->frames));
    enum neph_status status = neph_arena_check(run->arena, diag);
    for (int i = 0; i < run->field->count && !status; i++) {
        const int f = result->frame_count;
        if (!takes_part(run, i))
            continue;
        if (is_left_out(run, i, result)) {
            add_absent_frame(run, i, result);
            continue;
        }
        jobs[f].index = i;
        status = run_frame(run, i, scene, &result->frames[f], &jobs[f].chosen, diag);
        result->frame_count++;
    }
    return status ? status : run_second_seeds(run, scene, jobs, result, diag);
}

enum neph_status neph_scene_render(const struct neph_scene_run *run, const struct neph_scene *scene,
                                   struct neph_scene_result *result, bool *is_late,
                                   struct neph_diag *diag)
{
    const enum neph_status status = render_all(run, scene, result, diag);
    *is_late = false;
    for (int f = 0; f < result->frame_count; f++)
        *is_late |= neph_outcome_is_broken(result->frames[f].outcome);
    return status;
}

enum neph_status neph_scene_run(const struct neph_scene_run *run, const struct neph_scene *scene,
                                struct neph_scene_result *result, struct neph_diag *diag)
{
    describe(run, scene, result);
    enum neph_status status = render_all(run, scene, result, diag);
    if (!status)
        status = attribute(run, result, diag);
    result->truth = find_truth(result);
    if (!status)
        status = measure_all(run, scene, result, diag);
    if (!status)
        neph_gates_judge(scene, run->arena, result);
    return status ? status : neph_arena_check(run->arena, diag);
}

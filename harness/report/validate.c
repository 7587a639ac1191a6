/* SPDX-License-Identifier: MIT */
#include "harness/report/validate.h"

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/progress.h"
#include "harness/report/report.h"
#include "harness/report/scene_times.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Kinds of progress steps other than scene steps, for the estimate of the remaining time. */
enum { KIND_CHART = NEPH_SCENE_RUN_KINDS, KIND_TIMES, KIND_OVER_TIME };

static const double times_typical_s = 20.0; /* of one scene */

_Static_assert((int)KIND_OVER_TIME < (int)NEPH_PROGRESS_KINDS, "kinds of progress");

struct run {
    const struct neph_validate_params *params;
    struct neph_store *store;
    struct neph_validation *made;
    struct neph_progress progress;
    struct neph_scene_run scenes; /* state shared by all scenes */
    double start_s;
    int next;            /* index of the next scene without a result */
    int expected_frames; /* of all available scenes */
    struct told *told;   /* one for each scene, in the validation's arena */
};

/* Progress of a scene as reported by the workers. */
struct told {
    struct neph_scene_steps_done steps;
    bool is_over, is_late; /* the scene is rendered; some frames must be tried again */
};

static bool names_engine(const struct neph_validate_params *params,
                         const struct neph_engine *engine)
{
    for (int i = 0; i < params->engine_count; i++)
        if (strcmp(params->engines[i], engine->name) == 0)
            return true;
    return false;
}

/* True for an engine that can be a reference. `oracle` is excluded: it takes minutes for a frame
 * that `tracer` renders in seconds. */
static bool can_be_reference(const struct neph_engine *engine)
{
    return engine->rung <= NEPH_LEVEL_TRACER && !neph_engine_is_kind(engine, "oracle");
}

static enum neph_status choose_engines(const struct neph_validate_params *params,
                                       struct neph_run_engines *field, struct neph_diag *diag)
{
    int known;
    const struct neph_engine *const *engines = neph_engines_with_user_engines(&known);
    for (int i = 0; i < params->engine_count; i++)
        if (!neph_engine_find(params->engines[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", params->engines[i]);
            neph_hint(diag, "`neph engines` lists them");
            return NEPH_ERR_USAGE;
        }
    for (int i = 0; i < known; i++) {
        const bool is_named = names_engine(params, engines[i]);
        const bool is_reference = params->only_engines && can_be_reference(engines[i]);
        const bool is_usual = params->engine_count == 0 && !engines[i]->shortcut_of &&
                              !engines[i]->is_user_engine;
        if (!is_named && !is_reference && !is_usual)
            continue;
        const enum neph_status status = neph_engine_check_size(engines[i], params->width_px,
                                                               params->height_px, diag);
        if (status)
            return status;
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        field->engines[field->count] = engines[i];
        field->settings[field->count] = neph_settings_default(engines[i]);
        field->is_reference_only[field->count] = !is_named && is_reference;
        struct neph_engine_info *info = &field->infos[field->count++];
        neph_engine_probe(engines[i], params->device, info);
        if (info->warning[0])
            fprintf(stderr, "warning: %s: %s\n", engines[i]->name, info->warning);
    }
    return NEPH_OK;
}

static enum neph_status apply_setting(const char *text, struct neph_run_engines *field,
                                      struct neph_diag *diag)
{
    for (int i = 0; i < field->count; i++) {
        const char *assignment = neph_settings_match_engine(field->engines[i], text);
        if (assignment)
            return neph_settings_set(field->engines[i], &field->settings[i], assignment, diag);
    }
    neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is for none of the engines of this run", text);
    neph_hint(diag, "it is written ENGINE:KEY=VALUE, and -e names engines");
    return NEPH_ERR_USAGE;
}

static enum neph_status begin(struct run *run, struct neph_diag *diag)
{
    const struct neph_validate_params *params = run->params;
    struct neph_validation *made = run->made;
    const size_t count = (size_t)params->scene_count;
    neph_utc_now(made->created_utc);
    made->title = "Nephelometer validation";
    made->width_px = params->width_px;
    made->height_px = params->height_px;
    made->scenes = neph_arena_allocate(&made->arena, count, sizeof(*made->scenes));
    made->absent = neph_arena_allocate(&made->arena, count, sizeof(*made->absent));
    run->told = neph_arena_allocate(&made->arena, count, sizeof(*run->told));
    run->scenes = (struct neph_scene_run){.params = params,
                                          .field = &made->field,
                                          .store = run->store,
                                          .progress = &run->progress,
                                          .arena = &made->arena};
    return neph_arena_check(&made->arena, diag);
}

/* Select the plan of a scene. */
static void choose_scene(struct run *run, int index)
{
    run->scenes.plan = run->params->plans ? &run->params->plans[index] : NULL;
}

/* Add the current scene to the expected progress and frames, or remove it with -1. */
static void expect_scene(struct run *run, int count)
{
    neph_scene_run_expect(&run->scenes, count);
    run->expected_frames += count * neph_scene_run_engine_count(&run->scenes);
}

static void expect_all(struct run *run)
{
    const struct neph_validate_params *params = run->params;
    run->progress = neph_progress_start(params->quiet, 0);
    for (int i = 0; i < params->scene_count; i++) {
        choose_scene(run, i);
        expect_scene(run, 1);
    }
    if (params->times)
        neph_progress_expect(&run->progress, KIND_TIMES, params->scene_count, times_typical_s);
    if (params->charts)
        neph_progress_expect(&run->progress, KIND_CHART, neph_charts_step_count(params->charts),
                             NEPH_CHARTS_STEP_TYPICAL_S * params->charts->repeats);
    if (params->over_time)
        neph_progress_expect(&run->progress, KIND_OVER_TIME,
                             neph_over_time_step_count(params->over_time_floors),
                             NEPH_OVER_TIME_STEP_TYPICAL_S);
}

static void judge(struct run *run)
{
    neph_validation_judge(run->made, run->expected_frames);
    run->made->seconds = neph_wall_s() - run->start_s;
}

/* Set the verdict and the progress for a page that is published before the end of the run. */
static void judge_so_far(struct run *run, enum neph_verdict verdict)
{
    judge(run);
    run->made->verdict = verdict;
    neph_progress_count(&run->progress, &run->made->steps_done, &run->made->steps_total);
    run->made->left_s = neph_progress_left_s(&run->progress);
}

static enum neph_status show(struct run *run, struct neph_diag *diag)
{
    if (!run->params->report)
        return NEPH_OK;
    judge_so_far(run, NEPH_VERDICT_RUNNING);
    return neph_report_publish(run->params->report, run->made, diag);
}

/* Record a scene with missing data as absent and remove its progress steps. Clears `diag`. */
static void add_absent_scene(struct run *run, const char *name, struct neph_diag *diag)
{
    struct neph_arena *arena = &run->made->arena;
    char *clean = neph_text_clean_copy(name);
    run->made->absent[run->made->absent_count++] = (struct neph_absent_scene){
        .scene = neph_arena_copy_text(arena, clean ? clean : ""),
        .reason = neph_arena_copy_text(arena, diag->message),
        .hint = neph_arena_copy_text(arena, diag->hint)};
    free(clean);
    *diag = (struct neph_diag){.line = 0};
    if (run->params->times)
        neph_progress_expect(&run->progress, KIND_TIMES, -1, 0.0);
    expect_scene(run, -1);
}

/* Run the next scene. */
static enum neph_status run_scene(struct run *run, struct neph_diag *diag)
{
    struct neph_validation *made = run->made;
    const char *name = run->params->scenes[run->next];
    struct neph_scene_result *result = &made->scenes[made->scene_count];
    struct neph_scene *scene = NULL;
    choose_scene(run, run->next);
    enum neph_status status = neph_data_load_scene(name, &scene, diag);
    if (status == NEPH_ERR_NOT_FOUND && run->params->skip_absent) {
        run->next++;
        add_absent_scene(run, name, diag);
        return NEPH_OK;
    }
    run->scenes.told = run->told[run->next].steps;
    run->next++;
    if (!status)
        status = neph_scene_run(&run->scenes, scene, result, diag);
    if (status)
        neph_scene_result_finish(result);
    else
        made->scene_count++;
    neph_scene_destroy(scene);
    return status ? status : show(run, diag);
}

/* Measure frame times after all rendering is done. */
static enum neph_status time_scenes(struct run *run, struct neph_diag *diag)
{
    struct neph_validation *made = run->made;
    enum neph_status status = NEPH_OK;
    run->progress.kind = KIND_TIMES;
    for (int i = 0; i < made->scene_count && !status; i++) {
        struct neph_scene *scene = NULL;
        char what[128];
        snprintf(what, sizeof(what), "times of %s", made->scenes[i].name);
        neph_progress_begin(&run->progress, what);
        status = neph_data_load_scene(made->scenes[i].name, &scene, diag);
        if (!status)
            status = neph_scene_times(&run->scenes, scene, &made->scenes[i], diag);
        if (!status)
            neph_progress_over(&run->progress, what, "measured");
        neph_scene_destroy(scene);
    }
    return status ? status : show(run, diag);
}

static enum neph_status run_all(struct run *run, struct neph_diag *diag)
{
    const struct neph_validate_params *params = run->params;
    struct neph_validation *made = run->made;
    enum neph_status status = NEPH_OK;
    while (run->next < params->scene_count && !status)
        status = run_scene(run, diag);
    if (!status && params->times)
        status = time_scenes(run, diag);
    run->progress.kind = KIND_OVER_TIME;
    if (!status && params->over_time)
        status = neph_over_time_run(params->device, run->store, params->times,
                                    params->over_time_floors, &run->progress, &made->arena,
                                    &made->over_time, diag);
    if (!status && params->over_time)
        status = show(run, diag);
    run->progress.kind = KIND_CHART;
    if (!status && params->charts)
        status = neph_charts_run(params->charts, run->store, &run->progress, &made->arena,
                                 &made->charts, &made->chart_count, diag);
    return status;
}

/* ---- workers --------------------------------------------------------------------------------- */

/* Report a step to the main process as "SCENE KIND REUSED SECONDS NAME"; the end of a scene is
 * reported as "SCENE over LATE". */
static void report_step(const struct neph_scene_run *scenes, const char *what, bool reused,
                        double seconds)
{
    char text[512];
    snprintf(text, sizeof(text), "%d %d %d %.3f %s", scenes->scene, scenes->progress->kind, reused,
             seconds, what);
    neph_worker_send_message(scenes->worker, text);
}

/* Handle a worker's report: count the step as progress. Finished scenes get their results in the
 * order of the scenes. */
static enum neph_status hear(const char *text, void *context, struct neph_diag *diag)
{
    struct run *run = context;
    struct neph_progress *progress = &run->progress;
    int scene = 0, kind = 0, flag = 0, at = 0;
    double seconds;
    enum neph_status status = NEPH_OK;
    if (text && sscanf(text, "%d over %d", &scene, &flag) == 2) {
        run->told[scene].is_over = true;
        run->told[scene].is_late = flag;
    } else if (text && sscanf(text, "%d %d %d %lf %n", &scene, &kind, &flag, &seconds, &at) >= 4) {
        run->told[scene].steps.steps |= UINT64_C(1) << kind;
        run->told[scene].steps.made |= (uint64_t)!flag << kind;
        progress->kind = kind;
        neph_progress_step(progress, text + at, flag ? "reused" : "rendered", seconds);
        neph_progress_begin(progress, "several at a time");
    }
    while (!status && run->next < run->params->scene_count && run->told[run->next].is_over &&
           !run->told[run->next].is_late)
        status = run_scene(run, diag);
    return status;
}

/* Render a scene in a worker. Errors are ignored here: the main process repeats the scene and
 * reports them. */
static void render_scene(struct run *run, int index)
{
    struct neph_scene_result result = {.name = NULL};
    struct neph_scene *scene = NULL;
    struct neph_diag why = {.line = 0};
    bool is_late = false;
    char text[64];
    run->scenes.scene = index;
    choose_scene(run, index);
    enum neph_status status = neph_data_load_scene(run->params->scenes[index], &scene, &why);
    if (!status)
        status = neph_scene_render(&run->scenes, scene, &result, &is_late, &why);
    is_late |= status && status != NEPH_ERR_NOT_FOUND; /* a missing scene needs no repetition */
    snprintf(text, sizeof(text), "%d over %d", index, is_late);
    neph_worker_send_message(run->scenes.worker, text);
    neph_scene_result_finish(&result);
    neph_scene_destroy(scene);
}

/* Workers render scenes; the main process (index 0) renders the remaining frames and computes all
 * results. */
static enum neph_status work(struct neph_worker *worker, void *context, struct neph_diag *diag)
{
    struct run *run = context;
    if (worker->index == 0) {
        run->progress.workers = 1;
        return run_all(run, diag);
    }
    run->progress.quiet = true;
    run->scenes.tell = report_step;
    run->scenes.worker = worker;
    for (int i;
         !neph_interrupted() && (i = neph_worker_take_job(worker)) < run->params->scene_count;)
        render_scene(run, i);
    return NEPH_OK;
}

enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               struct neph_validation *validation, struct neph_diag *diag)
{
    struct run run = {
        .params = params, .store = store, .made = validation, .start_s = neph_wall_s()};
    enum neph_status status = neph_data_check_scenes(params->scenes, params->scene_count, diag);
    if (!status)
        status = choose_engines(params, &validation->field, diag);
    for (int i = 0; i < params->setting_count && !status; i++)
        status = apply_setting(params->settings[i], &validation->field, diag);
    if (!status)
        status = begin(&run, diag);
    if (status)
        return status;
    expect_all(&run);
    run.progress.workers = params->jobs < params->scene_count ? params->jobs : params->scene_count;
    status = neph_pool_run(run.progress.workers, params->device, work, hear, &run, diag);
    neph_progress_end(&run.progress);
    if (status == NEPH_ERR_INTERRUPTED)
        judge_so_far(&run, NEPH_VERDICT_INTERRUPTED);
    else if (!status)
        judge(&run);
    return status;
}

/* SPDX-License-Identifier: MIT
 *
 * Sweeps: points of a plan, ground truth, measurements, worker processes.
 */
#include "harness/sweep/sweep.h"

#include "base/clock.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/experiment/pool.h"
#include "harness/sweep/equal.h"
#include "harness/sweep/finest.h"
#include "harness/sweep/front.h"
#include "harness/sweep/point.h"
#include "scenes/motion.h"
#include "scenes/rescatter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_TRUTH, KIND_POINT, KIND_REFERENCE, KIND_ROUND }; /* of progress steps */

/* Expected seconds of a step, on two cores. */
static const double truth_typical_s = 60.0, point_typical_s = 6.0, round_typical_s = 20.0;

/* --- frames --------------------------------------------------------------------------------- */

/* Chooses the number of frames: at most the scene's where it moves. */
static enum neph_status choose_frames(struct neph_sweep *sweep, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    const int most = sweep->scene->frame_count / 4 * 4;
    sweep->frame_count = plan->frame_count;
    sweep->frame = 0;
    if (neph_scene_is_static(sweep->scene))
        return NEPH_OK;
    if (most < sweep->frame_count)
        sweep->frame_count = most;
    sweep->frame = sweep->frame_count - 1;
    if (sweep->frame_count - plan->warm_up >= NEPH_SWEEP_FRAMES_MIN)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s moves for %d frames, of which %d are warm-up",
              sweep->scene->name, sweep->scene->frame_count, plan->warm_up);
    if (most >= NEPH_SWEEP_FRAMES_MIN)
        neph_hint(diag, "a plan with a warm_up of %d or less leaves %d to measure",
                  most - NEPH_SWEEP_FRAMES_MIN, NEPH_SWEEP_FRAMES_MIN);
    else
        neph_hint(diag, "flicker needs %d frames or more", NEPH_SWEEP_FRAMES_MIN);
    return NEPH_ERR_UNSUPPORTED;
}

/* --- points --------------------------------------------------------------------------------- */

static bool is_wanted(const struct neph_sweep_params *params, int series, int place)
{
    const char *name = params->plan->series[series].name;
    bool wanted = !params->only;
    for (int i = 0; params->only && params->only[i]; i++)
        wanted |= strcmp(params->only[i], name) == 0;
    return wanted && (!params->wanted || params->wanted[series * NEPH_SWEEP_VALUES_MAX + place]);
}

/* Probes an engine when the plan uses it, once: some take a second to report their version. */
static const struct neph_engine_info *probe_engine_once(const struct neph_sweep_params *params,
                                                        const struct neph_sweep *sweep,
                                                        const struct neph_engine *engine)
{
    int count = 0, index = 0;
    const struct neph_engine *const *engines = neph_engines_with_user_engines(&count);
    while (engines[index] != engine)
        index++;
    struct neph_engine_info *info = &sweep->infos[index];
    if (!info->available && !info->missing[0])
        neph_engine_probe(engine, params->device, info);
    return info;
}

static enum neph_status ensure_scattering_scene(struct neph_sweep *sweep,
                                                enum neph_scattering scattering,
                                                const struct neph_scene **scene,
                                                struct neph_diag *diag)
{
    struct neph_scene **other = &sweep->rescattered[scattering];
    enum neph_status status = NEPH_OK;
    *scene = sweep->scene;
    if (scattering == sweep->scene->scattering)
        return NEPH_OK;
    if (!*other)
        status = neph_scene_rescatter(sweep->scene, scattering, other, diag);
    *scene = *other;
    return status;
}

static enum neph_status fill_point(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                   const struct neph_sweep_series *series, int place,
                                   struct neph_sweep_point *point, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = params->plan;
    const enum neph_scattering scattering = neph_sweep_scattering(series, sweep->scene);
    const struct neph_engine *engine = neph_sweep_engine(plan, series, scattering);
    const struct neph_engine_info *info = probe_engine_once(params, sweep, engine);
    *point = (struct neph_sweep_point){
        .series = series,
        .place = place,
        .job = {.engine = engine,
                .info = info,
                .shot = {.scene = NULL,
                         .width_px = plan->width_px,
                         .height_px = plan->height_px,
                         .layers = NEPH_LAYERS_ALL,
                         .seed = (uint64_t)params->seed,
                         .time_limit_s = params->time_limit_s,
                         .device = params->device}},
        .time = {NAN, NAN, NAN},
        .evaluations = NAN,
        .to_finest = {NAN, NAN, NAN},
        .floors = {NAN, NAN, NAN, NAN, NAN},
    };
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        point->numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
    neph_sweep_value(series, place, point->label);
    const char *shortcut_of = neph_sweep_is_sequence(point) ? engine->shortcut_of : NULL;
    struct neph_shot *shot = &point->job.shot;
    enum neph_status status = ensure_scattering_scene(sweep, scattering, &shot->scene, diag);
    if (!status)
        status = neph_engine_check_size(engine, plan->width_px, plan->height_px, diag);
    if (!status && shortcut_of) /* its reference has the same size */
        status = neph_engine_check_size(neph_engine_find(shortcut_of), plan->width_px,
                                        plan->height_px, diag);
    if (!status)
        status = neph_sweep_settings(plan, series, place, scattering, &shot->settings, diag);
    if (!status)
        neph_settings_adapt_to_scene(engine, shot->scene, &shot->settings);
    if (!status && !(point->settings = neph_settings_text(engine, &shot->settings)))
        status = neph_fail_memory(diag);
    if (!status && !info->available)
        snprintf(point->missing, sizeof(point->missing), "%.500s", info->missing);
    else if (!status)
        engine->can_render(shot->scene, &shot->settings, point->missing, sizeof(point->missing));
    shot->frame = neph_sweep_is_sequence(point) ? 0 : sweep->frame;
    return status;
}

static enum neph_status fill_points(const struct neph_sweep_params *params,
                                    struct neph_sweep *sweep, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = params->plan;
    enum neph_status status = NEPH_OK;
    int engine_count = 0;
    neph_engines_with_user_engines(&engine_count);
    sweep->infos = calloc((size_t)engine_count, sizeof(*sweep->infos));
    sweep->points = calloc(NEPH_SWEEP_POINTS_MAX, sizeof(*sweep->points));
    if (!sweep->points || !sweep->infos)
        return neph_fail_memory(diag);
    for (int s = 0; s < plan->series_count; s++)
        for (int i = 0; i < neph_sweep_value_count(&plan->series[s]) && !status; i++)
            if (is_wanted(params, s, i))
                status = fill_point(params, sweep, &plan->series[s], i,
                                    &sweep->points[sweep->point_count++], diag);
    return status;
}

static bool has_series(const struct neph_sweep_plan *plan, const char *name)
{
    for (int s = 0; s < plan->series_count; s++)
        if (strcmp(plan->series[s].name, name) == 0)
            return true;
    return false;
}

/* Refuses unknown names of series before any rendering. */
static enum neph_status check_only(const struct neph_sweep_params *params, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = params->plan;
    const char *const *name = params->only;
    char names[512] = "";
    while (name && *name && has_series(plan, *name))
        name++;
    if (!name || !*name)
        return NEPH_OK;
    for (int s = 0; s < plan->series_count; s++) {
        const size_t used = strlen(names);
        snprintf(names + used, sizeof(names) - used, "%s%s", s > 0 ? ", " : "",
                 plan->series[s].name);
    }
    neph_fail(diag, NEPH_ERR_USAGE, "the plan has no series '%s'", *name);
    neph_hint(diag, "its series are %s", names);
    return NEPH_ERR_USAGE;
}

/* --- measuring ------------------------------------------------------------------------------ */

/* Sorts points with the same label behind each other, as these share their reference. */
static int by_reference(const void *a_, const void *b_)
{
    const struct neph_sweep_point *a = *(struct neph_sweep_point *const *)a_,
                                  *b = *(struct neph_sweep_point *const *)b_;
    const int by_label = strcmp(a->label, b->label);
    return by_label ? by_label : (a > b) - (a < b);
}

static enum neph_status measure_point(struct neph_sweep_context *bench,
                                      struct neph_sweep_point *point, struct neph_diag *diag)
{
    char what[160];
    snprintf(what, sizeof(what), "%s %s", point->series->name, point->label);
    bench->progress->kind = KIND_REFERENCE;
    neph_progress_begin(bench->progress, what);
    const double start_s = neph_wall_s();
    const enum neph_status status = point->missing[0]
                                        ? NEPH_OK
                                        : neph_sweep_point_measure(bench, point, diag);
    bench->progress->kind = KIND_POINT;
    if (!status)
        neph_progress_step(bench->progress, what, point->missing[0] ? point->missing : "measured",
                           neph_wall_s() - start_s);
    return status;
}

/* Points in an order in which they share references, to free; NULL: out of memory. */
static struct neph_sweep_point **order_points(const struct neph_sweep *sweep)
{
    const size_t count = (size_t)sweep->point_count, size = sizeof(struct neph_sweep_point *);
    struct neph_sweep_point **order = calloc(count, size);
    for (size_t i = 0; i < count && order; i++)
        order[i] = &sweep->points[i];
    if (order)
        qsort(order, count, size, by_reference);
    return order;
}

static enum neph_status measure_points(struct neph_sweep_context *bench,
                                       const struct neph_sweep *sweep, struct neph_diag *diag)
{
    struct neph_sweep_point **order = order_points(sweep);
    enum neph_status status = order ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < sweep->point_count && !status; i++)
        status = measure_point(bench, order[i], diag);
    free(order);
    return status;
}

/* --- fronts --------------------------------------------------------------------------------- */

static enum neph_status find_fronts(struct neph_sweep *sweep, bool untimed, struct neph_diag *diag)
{
    const enum neph_sweep_cost cost = untimed ? NEPH_SWEEP_COST_WORK : NEPH_SWEEP_COST_TIME;
    struct neph_front_point *front = calloc((size_t)sweep->point_count, sizeof(*front));
    if (!front)
        return neph_fail_memory(diag);
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++) {
        for (int i = 0; i < sweep->point_count; i++) {
            front[i].values[0] = neph_sweep_point_cost(&sweep->points[i], cost);
            front[i].values[1] = sweep->points[i].numbers[n].value;
        }
        neph_front_find(front, sweep->point_count, 2);
        for (int i = 0; i < sweep->point_count; i++)
            sweep->points[i].on_front[n] = front[i].on_front;
    }
    free(front);
    return NEPH_OK;
}

/* --- the whole ------------------------------------------------------------------------------ */

static enum neph_status make_truth(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                   struct neph_store *store, struct neph_progress *progress,
                                   struct neph_sweep_truth *truth, struct neph_diag *diag)
{
    progress->kind = KIND_TRUTH;
    neph_progress_begin(progress, "truth");
    struct neph_shot shot = sweep->points[0].job.shot;
    shot.scene = sweep->scene; /* with all its scattering, whatever the first series has */
    shot.frame = sweep->frame;
    const enum neph_status status = neph_sweep_truth_make(params->plan, &shot, store, truth, diag);
    if (status)
        return status;
    neph_progress_over(progress, "truth", "rendered");
    sweep->truth = truth->engine->name;
    sweep->floor = truth->noise;
    sweep->clear_of = truth->mask;
    return NEPH_OK;
}

static enum neph_status run_bench(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                  struct neph_sweep_context *bench, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    enum neph_status status = measure_points(bench, sweep, diag);
    sweep->mask = bench->mask;
    if (!status)
        status = neph_sweep_measure_finest(sweep, bench->truth, bench->store, diag);
    bench->progress->kind = KIND_ROUND;
    if (!status && !params->untimed)
        status = neph_sweep_time(bench, sweep->points, sweep->point_count, diag);
    sweep->load = neph_sweep_load();
    sweep->measure_s = neph_wall_s() - start_s;
    return status ? status : find_fronts(sweep, params->untimed, diag);
}

static enum neph_status prepare(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                struct neph_diag *diag)
{
    *sweep = (struct neph_sweep){.plan = params->plan, .against = params->against};
    enum neph_status status = check_only(params, diag);
    if (!status)
        status = neph_data_load_scene(params->scene, &sweep->scene, diag);
    if (!status)
        status = choose_frames(sweep, diag);
    return status ? status : fill_points(params, sweep, diag);
}

/* A sweep and the progress of its workers. */
struct sweep_run_state {
    const struct neph_sweep_params *params;
    struct neph_store *store;
    struct neph_sweep *sweep;
    struct neph_progress progress; /* of the workers */
};

static struct neph_sweep_context make_sweep_context(const struct sweep_run_state *sweep_run_state,
                                                    const struct neph_sweep *sweep,
                                                    const struct neph_sweep_truth *truth,
                                                    struct neph_progress *progress)
{
    const struct neph_sweep_params *params = sweep_run_state->params;
    return (struct neph_sweep_context){.plan = params->plan,
                                       .with_floors = params->with_floors,
                                       .truth = truth,
                                       .store = sweep_run_state->store,
                                       .progress = progress,
                                       .frame_count = sweep->frame_count,
                                       .frame = sweep->frame,
                                       .mask = "all",
                                       .times = params->times,
                                       .remeasures_times = params->remeasures_times,
                                       .seed = (uint64_t)params->seed};
}

static enum neph_status run_main_process(const struct sweep_run_state *sweep_run_state,
                                         struct neph_diag *diag)
{
    const struct neph_sweep_params *params = sweep_run_state->params;
    struct neph_sweep *sweep = sweep_run_state->sweep;
    struct neph_progress progress = neph_progress_start(params->quiet, 0);
    struct neph_sweep_truth truth = {.image = NULL};
    enum neph_status status = prepare(params, sweep, diag);
    neph_progress_expect(&progress, KIND_TRUTH, 1, truth_typical_s);
    neph_progress_expect(&progress, KIND_POINT, sweep->point_count, point_typical_s);
    if (!params->untimed)
        neph_progress_expect(&progress, KIND_ROUND, params->plan->round_count, round_typical_s);
    if (!status)
        status = make_truth(params, sweep, sweep_run_state->store, &progress, &truth, diag);
    struct neph_sweep_context bench = make_sweep_context(sweep_run_state, sweep, &truth, &progress);
    if (!status)
        status = run_bench(params, sweep, &bench, diag);
    neph_sweep_context_finish(&bench);
    neph_sweep_truth_finish(&truth);
    neph_progress_end(&progress);
    return status;
}

/* --- several processes ---------------------------------------------------------------------- */

/* Start of a group of points that share a reference; `count`: there are no more groups. */
static int start_of_group(struct neph_sweep_point *const *order, int count, int group)
{
    int start = 0;
    for (int i = 1; i <= count && group > 0; i++)
        if (i == count || strcmp(order[i]->label, order[i - 1]->label) != 0) {
            start = i;
            group--;
        }
    return start;
}

/* A single frame may be timed by its rendering, so the main process renders it without other load.
 */
static bool is_for_workers(const struct neph_sweep_point *point)
{
    return neph_sweep_is_sequence(point) || neph_flight_applies(point->job.engine);
}

/* Renders the groups of a worker, so that their frames are in the store for the main process. No
 * error is measured here, as only the main process has the ground truth. */
static enum neph_status run_groups(const struct sweep_run_state *sweep_run_state,
                                   struct neph_worker *worker, struct neph_diag *diag)
{
    const struct neph_sweep_truth no_truth = {.image = NULL};
    struct neph_progress progress = neph_progress_start(true, 0);
    struct neph_sweep sweep;
    enum neph_status status = prepare(sweep_run_state->params, &sweep, diag);
    struct neph_sweep_context bench = make_sweep_context(sweep_run_state, &sweep, &no_truth,
                                                         &progress);
    struct neph_sweep_point **order = status ? NULL : order_points(&sweep);
    for (int start = 0; order && !status && start < sweep.point_count;) {
        const int group = neph_worker_take_job(worker);
        const int end = start_of_group(order, sweep.point_count, group + 1);
        start = start_of_group(order, sweep.point_count, group);
        for (int i = start; i < end && !status; i++)
            if (is_for_workers(order[i]))
                status = measure_point(&bench, order[i], diag);
        if (start < end)
            neph_worker_send_message(worker, order[start]->series->name);
    }
    free(order);
    neph_sweep_context_finish(&bench);
    neph_sweep_finish(&sweep);
    return status;
}

static enum neph_status run_part(struct neph_worker *worker, void *sweep_run_state,
                                 struct neph_diag *diag)
{
    return worker->index > 0 ? run_groups(sweep_run_state, worker, diag)
                             : run_main_process(sweep_run_state, diag);
}

static enum neph_status read_worker_message(const char *text, void *context, struct neph_diag *diag)
{
    struct sweep_run_state *sweep_run_state = context;
    (void)diag;
    if (text)
        neph_progress_tick(&sweep_run_state->progress, text);
    return NEPH_OK;
}

enum neph_status neph_sweep_run(const struct neph_sweep_params *params, struct neph_store *store,
                                struct neph_sweep *sweep, struct neph_diag *diag)
{
    struct sweep_run_state sweep_run_state = {params, store, sweep,
                                              neph_progress_start(params->quiet, 0)};
    *sweep = (struct neph_sweep){.plan = params->plan};
    const enum neph_status status = neph_pool_run(params->jobs, params->device, run_part,
                                                  read_worker_message, &sweep_run_state, diag);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    return status;
}

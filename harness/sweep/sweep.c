/* SPDX-License-Identifier: MIT */
#include "harness/sweep/sweep.h"

#include "base/clock.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/sweep/equal.h"
#include "harness/sweep/front.h"
#include "harness/sweep/ladder.h"
#include "harness/sweep/timing.h"
#include "scenes/rescatter.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_TRUTH, KIND_POINT, KIND_REFERENCE, KIND_ROUND }; /* of progress */

/* Guesses on two cores. */
static const double truth_typical_s = 60.0, point_typical_s = 6.0, round_typical_s = 20.0;

/* --- pictures ------------------------------------------------------------------------------- */

/* Motion ends with the scene. */
static enum neph_status choose_frames(struct neph_sweep *sweep, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    const int most = sweep->scene->frame_count / 4 * 4;
    sweep->frame_count = plan->frame_count;
    sweep->frame = 0;
    if (neph_ladder_is_still(sweep->scene))
        return NEPH_OK;
    if (most < sweep->frame_count)
        sweep->frame_count = most;
    sweep->frame = sweep->frame_count - 1;
    if (sweep->frame_count - plan->warm_up >= NEPH_SWEEP_FRAMES_MIN)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s moves for %d pictures, of which %d are warm-up",
              sweep->scene->name, sweep->scene->frame_count, plan->warm_up);
    if (most >= NEPH_SWEEP_FRAMES_MIN)
        neph_hint(diag, "a plan with a warm_up of %d or less has %d to measure",
                  most - NEPH_SWEEP_FRAMES_MIN, NEPH_SWEEP_FRAMES_MIN);
    else
        neph_hint(diag, "flicker is of %d pictures or more", NEPH_SWEEP_FRAMES_MIN);
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

static const struct neph_engine_info *info_of(const struct neph_sweep *sweep,
                                              const struct neph_engine *engine)
{
    int count = 0, index = 0;
    const struct neph_engine *const *engines = neph_engines_and_guests(&count);
    while (engines[index] != engine)
        index++;
    return &sweep->infos[index];
}

static enum neph_status have_scene(struct neph_sweep *sweep, enum neph_scattering scattering,
                                   const struct neph_scene **scene, struct neph_diag *diag)
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
    const struct neph_engine_info *info = info_of(sweep, engine);
    *point = (struct neph_sweep_point){
        .series = series,
        .place = place,
        .job = {.engine = engine,
                .info = info,
                .shot = {.scene = NULL,
                         .width_px = plan->width_px,
                         .height_px = plan->height_px,
                         .layers = NEPH_LAYERS_ALL,
                         .seed = params->seed,
                         .time_limit_s = params->time_limit_s,
                         .device = params->device}},
        .time = {NAN, NAN, NAN},
        .evaluations = NAN,
    };
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        point->numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
    neph_sweep_value(series, place, point->label);
    struct neph_shot *shot = &point->job.shot;
    enum neph_status status = have_scene(sweep, scattering, &shot->scene, diag);
    if (!status)
        status = neph_sweep_settings(plan, series, place, scattering, &shot->settings, diag);
    if (!status)
        neph_settings_meet(engine, shot->scene, &shot->settings);
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
    sweep->points = calloc(NEPH_SWEEP_POINTS_MAX, sizeof(*sweep->points));
    if (!sweep->points)
        return neph_fail_memory(diag);
    for (int s = 0; s < plan->series_count; s++)
        for (int i = 0; i < neph_sweep_value_count(&plan->series[s]) && !status; i++)
            if (is_wanted(params, s, i))
                status = fill_point(params, sweep, &plan->series[s], i,
                                    &sweep->points[sweep->point_count++], diag);
    return status;
}

/* Names that the plan has not got are told before anything is rendered. */
static enum neph_status check_only(const struct neph_sweep_params *params, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = params->plan;
    char names[512] = "";
    for (int s = 0; s < plan->series_count; s++) {
        const size_t used = strlen(names);
        snprintf(names + used, sizeof(names) - used, "%s%s", s > 0 ? ", " : "",
                 plan->series[s].name);
    }
    for (int i = 0; params->only && params->only[i]; i++) {
        bool is_there = false;
        for (int s = 0; s < plan->series_count; s++)
            is_there |= strcmp(plan->series[s].name, params->only[i]) == 0;
        if (!is_there) {
            neph_fail(diag, NEPH_ERR_USAGE, "the plan has no series '%s'", params->only[i]);
            neph_hint(diag, "its series are %s", names);
            return NEPH_ERR_USAGE;
        }
    }
    return NEPH_OK;
}

/* Those of the plan alone: some take a second to tell their version. */
static enum neph_status probe_engines(const struct neph_sweep_params *params,
                                      struct neph_sweep *sweep, struct neph_diag *diag)
{
    const struct neph_sweep_plan *plan = params->plan;
    int count = 0;
    const struct neph_engine *const *engines = neph_engines_and_guests(&count);
    sweep->infos = calloc((size_t)count, sizeof(*sweep->infos));
    if (!sweep->infos)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++) {
        bool is_asked = false;
        for (int s = 0; s < plan->series_count; s++)
            for (int k = 0; k < neph_sweep_value_count(&plan->series[s]) && !is_asked; k++)
                is_asked = is_wanted(params, s, k) &&
                           neph_sweep_engine(
                               plan, &plan->series[s],
                               neph_sweep_scattering(&plan->series[s], sweep->scene)) == engines[i];
        if (is_asked)
            neph_engine_probe(engines[i], params->device, &sweep->infos[i]);
    }
    return NEPH_OK;
}

/* --- measuring ------------------------------------------------------------------------------ */

/* Points with the same steps behind each other share their reference. */
static int by_reference(const void *a_, const void *b_)
{
    const struct neph_sweep_point *a = *(struct neph_sweep_point *const *)a_,
                                  *b = *(struct neph_sweep_point *const *)b_;
    const int by_label = strcmp(a->label, b->label);
    return by_label ? by_label : (a > b) - (a < b);
}

static enum neph_status measure_point(struct neph_sweep_bench *bench,
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

static enum neph_status measure_points(struct neph_sweep_bench *bench, struct neph_sweep *sweep,
                                       struct neph_diag *diag)
{
    struct neph_sweep_point **order = calloc((size_t)sweep->point_count, sizeof(*order));
    enum neph_status status = order ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < sweep->point_count && order; i++)
        order[i] = &sweep->points[i];
    if (!status)
        qsort(order, (size_t)sweep->point_count, sizeof(struct neph_sweep_point *), by_reference);
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
            front[i].values[0] = neph_sweep_cost_of(&sweep->points[i], cost);
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

static void expect(struct neph_progress *progress, const struct neph_sweep *sweep, bool untimed)
{
    neph_progress_expect(progress, KIND_TRUTH, 1, truth_typical_s);
    neph_progress_expect(progress, KIND_POINT, sweep->point_count, point_typical_s);
    if (!untimed)
        neph_progress_expect(progress, KIND_ROUND, sweep->plan->round_count, round_typical_s);
}

static enum neph_status make_truth(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                   struct neph_store *store, struct neph_progress *progress,
                                   struct neph_sweep_truth *truth, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    progress->kind = KIND_TRUTH;
    neph_progress_begin(progress, "truth");
    struct neph_shot shot = sweep->points[0].job.shot;
    shot.scene = sweep->scene; /* with all its orders, whatever that series has */
    shot.frame = sweep->frame;
    const enum neph_status status = neph_sweep_truth_make(params->plan, &shot, store, truth, diag);
    if (status)
        return status;
    neph_progress_step(progress, "truth", "rendered", neph_wall_s() - start_s);
    sweep->truth = truth->engine->name;
    sweep->floor = truth->noise;
    sweep->clear_of = truth->mask;
    return NEPH_OK;
}

static enum neph_status run_bench(const struct neph_sweep_params *params, struct neph_sweep *sweep,
                                  struct neph_sweep_bench *bench, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    enum neph_status status = measure_points(bench, sweep, diag);
    sweep->mask = bench->mask;
    bench->progress->kind = KIND_ROUND;
    if (!status && !params->untimed)
        status = neph_sweep_time(bench, sweep->points, sweep->point_count, diag);
    sweep->load = neph_sweep_load();
    sweep->measure_s = neph_wall_s() - start_s;
    return status ? status : find_fronts(sweep, params->untimed, diag);
}

enum neph_status neph_sweep_run(const struct neph_sweep_params *params, struct neph_store *store,
                                struct neph_sweep *sweep, struct neph_diag *diag)
{
    struct neph_progress progress = neph_progress_start(params->quiet, 0);
    struct neph_sweep_truth truth = {.image = NULL};
    *sweep = (struct neph_sweep){.plan = params->plan, .against = params->against};
    enum neph_status status = check_only(params, diag);
    if (!status)
        status = neph_data_load_scene(params->scene, &sweep->scene, diag);
    if (!status)
        status = choose_frames(sweep, diag);
    if (!status)
        status = probe_engines(params, sweep, diag);
    if (!status)
        status = fill_points(params, sweep, diag);
    if (!status)
        expect(&progress, sweep, params->untimed);
    if (!status)
        status = make_truth(params, sweep, store, &progress, &truth, diag);
    struct neph_sweep_bench bench = {.plan = params->plan,
                                     .truth = &truth,
                                     .store = store,
                                     .progress = &progress,
                                     .frame_count = sweep->frame_count,
                                     .frame = sweep->frame,
                                     .mask = "all",
                                     .times = params->times,
                                     .retimes = params->retimes,
                                     .seed = params->seed};
    if (!status)
        status = run_bench(params, sweep, &bench, diag);
    neph_sweep_bench_finish(&bench);
    neph_sweep_truth_finish(&truth);
    neph_progress_end(&progress);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "what is finished is in the store: the same command goes on from there");
    return status;
}

/* SPDX-License-Identifier: MIT
 *
 * Each point is a setting: the error is the relative RMSE of radiance against `exact`, the time
 * that of the radiance pass alone. A point is measured `repeats` times (with another seed where the
 * engine draws random numbers): the middle one is shown, the smallest and largest are its bars.
 */
#include "harness/report/charts.h"

#include "base/clock.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/sort.h"
#include "harness/compare/measure.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/report/vega.h"
#include "harness/run/job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { POINTS_MAX = 6 };

/* Small, so that a chart takes a minute; errors of a mean over the image do not depend on it. */
static const int chart_width_px = 48, chart_height_px = 27;

struct series {
    const char *name;
    const char *engine;
    const char *fixed;  /* a setting held over the series; NULL: none */
    const char *varied; /* the setting that changes */
    double values[POINTS_MAX];
    int count;
    double order; /* of the ideal line drawn beside it: error ~ seconds^-order */
};

static const struct series slab_series[] = {
    {"march: steps", "march", NULL, "steps", {2, 4, 8, 16, 32, 64}, 6, 2.0},
    {"Cycles: samples", "cycles", NULL, "samples", {1, 4, 16, 64, 256}, 5, 0.5},
    {"POV-Ray: intervals", "povray", NULL, "intervals", {4, 8, 16, 32, 64}, 5, 2.0},
};
static const struct series fog_series[] = {
    {"march: steps", "march", NULL, "steps", {4, 8, 16, 32, 64, 128}, 6, 2.0},
    {"Cycles: samples", "cycles", NULL, "samples", {1, 4, 16, 64}, 4, 0.5},
    {"Cycles: step, 64 samples", "cycles", "samples=64", "step", {4, 2, 1, 0.5}, 4, 0.0},
    {"POV-Ray: intervals", "povray", NULL, "intervals", {4, 8, 16, 32, 64}, 5, 1.0},
};

static const struct chart {
    const char *id, *scene, *title;
    const struct series *series;
    int series_count;
} charts_table[] = {
    {"slab", "scattering_slab_above", "Single scattering in a homogeneous slab", slab_series,
     sizeof(slab_series) / sizeof(slab_series[0])},
    {"fog", "height_fog_level", "Single scattering in height fog", fog_series,
     sizeof(fog_series) / sizeof(fog_series[0])},
};
enum { CHART_COUNT = sizeof(charts_table) / sizeof(charts_table[0]) };

struct point {
    int repeats;
    double seconds[NEPH_CHARTS_REPEATS_MAX], error[NEPH_CHARTS_REPEATS_MAX]; /* ascending */
    char label[64];
};

struct sweep {
    const struct neph_scene *scene;
    struct neph_image *truth;
    struct neph_store *store;
    struct neph_progress *progress;
    int repeats;
    double time_limit_s;
    struct neph_shared_device *device;
    json_t *points, *slopes; /* of a chart; owned */
    char absent[512];        /* what is missing there */
};

static struct neph_job make_job(const struct sweep *sweep, const struct neph_engine *engine,
                                const struct neph_engine_info *info, int repeat)
{
    return (struct neph_job){
        .engine = engine,
        .info = info,
        .repeat = repeat,
        .shot = {.scene = sweep->scene,
                 .settings = neph_settings_default(engine),
                 .width_px = chart_width_px,
                 .height_px = chart_height_px,
                 .layers = NEPH_LAYER_RADIANCE,
                 .seed = (uint64_t)repeat + 1,
                 .time_limit_s = sweep->time_limit_s,
                 .device = sweep->device},
    };
}

static enum neph_status relative_rmse(const struct sweep *sweep, const char *frame_path,
                                      double *error, struct neph_diag *diag)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS; /* linear errors do not ask for it */
    struct neph_image *image = NULL;
    struct neph_measurements measurements = {0};
    enum neph_status status = neph_exr_read(frame_path, &image, diag);
    if (!status)
        status = neph_measure(sweep->truth, image, "error", &viewing, &measurements, diag);
    const struct neph_measurement *found = neph_measurement_find(&measurements, "radiance",
                                                                 "rel_rmse", "all");
    if (!status)
        *error = found ? found->value : 0.0;
    neph_measurements_finish(&measurements);
    neph_image_destroy(image);
    return status;
}

/* All repeats of one setting; `*rendered` tells whether the engine could. */
static enum neph_status measure_point(const struct sweep *sweep, const struct neph_engine *engine,
                                      const struct neph_engine_info *info,
                                      const struct series *series, double value,
                                      struct point *point, bool *rendered, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *rendered = true;
    snprintf(point->label, sizeof(point->label), "%s=%g", series->varied, value);
    char what[160];
    snprintf(what, sizeof(what), "chart of %s: %s %s", sweep->scene->name, engine->name,
             point->label);
    neph_progress_begin(sweep->progress, what);
    const double start_s = neph_wall_s();
    point->repeats = sweep->repeats;
    for (int repeat = 0; repeat < sweep->repeats && !status && *rendered; repeat++) {
        struct neph_job job = make_job(sweep, engine, info, repeat);
        struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
        if (series->fixed)
            status = neph_settings_set(engine, &job.shot.settings, series->fixed, diag);
        if (!status)
            status = neph_settings_set(engine, &job.shot.settings, point->label, diag);
        if (!status)
            status = neph_job_run(&job, sweep->store, &result, diag);
        *rendered = !status && result.outcome == NEPH_OUTCOME_RENDERED;
        if (*rendered) {
            point->seconds[repeat] = result.cost.render_s;
            status = relative_rmse(sweep, result.frame_path, &point->error[repeat], diag);
        }
        neph_job_result_finish(&result);
    }
    neph_progress_step(sweep->progress, what, *rendered ? "measured" : "not measured",
                       neph_wall_s() - start_s);
    neph_sort_doubles(point->seconds, (size_t)point->repeats);
    neph_sort_doubles(point->error, (size_t)point->repeats);
    return status;
}

/* `place`: rank of the setting in its series, by which the points are joined. */
static json_t *point_json(const struct series *series, const struct point *point, int place)
{
    const int middle = point->repeats / 2, last = point->repeats - 1;
    return json_pack("{s:s, s:s, s:s, s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:s}", "series",
                     series->name, "engine", series->engine, "label", point->label, "place", place,
                     "seconds", point->seconds[middle], "seconds_low", point->seconds[0],
                     "seconds_high", point->seconds[last], "error", point->error[middle],
                     "error_low", point->error[0], "error_high", point->error[last], "unit",
                     "relative RMSE of radiance");
}

/* The ideal line of a series starts at half the error of its first point and ends at the time of
 * its last. */
static void add_slope(struct sweep *sweep, const struct series *series, const struct point *first,
                      const struct point *last)
{
    if (series->order <= 0.0)
        return;
    const int middle = first->repeats / 2;
    const double start_s = first->seconds[middle], end_s = last->seconds[middle];
    const double error = 0.5 * first->error[middle];
    char line[96];
    snprintf(line, sizeof(line), "%s: error ~ 1/time^%g", series->engine, series->order);
    neph_json_add(&sweep->slopes,
                  json_pack("{s:s, s:f, s:f}", "line", line, "seconds", start_s, "error", error));
    neph_json_add(&sweep->slopes, json_pack("{s:s, s:f, s:f}", "line", line, "seconds", end_s,
                                            "error", error * pow(end_s / start_s, -series->order)));
}

static enum neph_status run_series(struct sweep *sweep, const struct series *series,
                                   struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(series->engine);
    struct neph_engine_info info;
    struct point measured[POINTS_MAX] = {{.repeats = 0}};
    int count = 0;
    enum neph_status status = NEPH_OK;
    neph_engine_probe(engine, sweep->device, &info);
    for (int i = 0; i < series->count && !status; i++) {
        bool rendered;
        status = measure_point(sweep, engine, &info, series, series->values[i], &measured[count],
                               &rendered, diag);
        if (!status && rendered)
            neph_json_add(&sweep->points, point_json(series, &measured[count++], i));
    }
    if (count >= 2)
        add_slope(sweep, series, &measured[0], &measured[count - 1]);
    if (!status && count < series->count) {
        const size_t used = strlen(sweep->absent);
        snprintf(sweep->absent + used, sizeof(sweep->absent) - used,
                 " %s: %d of %d points not rendered.", series->name, series->count - count,
                 series->count);
    }
    return status;
}

static enum neph_status render_truth(struct sweep *sweep, struct neph_diag *diag)
{
    const struct neph_engine *exact = neph_engine_find("exact");
    struct neph_engine_info info;
    neph_engine_probe(exact, sweep->device, &info);
    const struct neph_job job = make_job(sweep, exact, &info, 0);
    struct neph_cost cost;
    return neph_job_render(&job, &sweep->truth, &cost, diag);
}

/* What is drawn, how often each point was run, and what is not there. */
static const char *make_caption(const struct chart *chart, const struct sweep *sweep,
                                struct neph_arena *arena)
{
    char runs[160] = "One run of each point: how they scatter is not known.";
    if (sweep->repeats > 1)
        snprintf(runs, sizeof(runs),
                 "Middle of %d runs (other seeds where the engine draws random numbers), bars from "
                 "the smallest to the largest.",
                 sweep->repeats);
    return neph_arena_format(arena,
                             "Scene %s at %dx%d px against exact. Seconds of the radiance pass "
                             "alone, without start-up. %s A point without error is not drawn.%s",
                             chart->scene, chart_width_px, chart_height_px, runs, sweep->absent);
}

/* The points of all series, in the specification. */
static enum neph_status fill_spec(const struct chart *chart, struct sweep *sweep, json_t *spec,
                                  struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < chart->series_count && !status; i++)
        status = run_series(sweep, &chart->series[i], diag);
    json_t *datasets = json_object_get(spec, "datasets");
    if (!status)
        status = neph_json_put(datasets, "points", json_incref(sweep->points), diag);
    return status ? status : neph_json_put(datasets, "slopes", json_incref(sweep->slopes), diag);
}

static enum neph_status run_chart(const struct chart *chart, struct sweep *sweep,
                                  struct neph_arena *arena, struct neph_chart *made,
                                  struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    json_t *spec = NULL;
    enum neph_status status = neph_data_load_scene(chart->scene, &scene, diag);
    if (!status)
        status = neph_vega_template("speed_accuracy.vl.json", &spec, diag);
    sweep->scene = scene;
    sweep->truth = NULL;
    sweep->points = json_array();
    sweep->slopes = json_array();
    sweep->absent[0] = '\0';
    if (!status)
        status = render_truth(sweep, diag);
    if (!status)
        status = fill_spec(chart, sweep, spec, diag);
    if (!status)
        *made = (struct neph_chart){.id = chart->id,
                                    .title = chart->title,
                                    .caption = make_caption(chart, sweep, arena),
                                    .spec = json_incref(spec)};
    json_decref(sweep->points);
    json_decref(sweep->slopes);
    json_decref(spec);
    neph_image_destroy(sweep->truth);
    neph_scene_destroy(scene);
    return status;
}

static bool is_wanted(const struct neph_charts_params *params, const struct chart *chart)
{
    bool wanted = !params->ids;
    for (int i = 0; params->ids && params->ids[i]; i++)
        wanted |= strcmp(params->ids[i], chart->id) == 0;
    return wanted;
}

int neph_charts_step_count(const struct neph_charts_params *params)
{
    int count = 0;
    for (size_t i = 0; i < CHART_COUNT; i++)
        for (int k = 0; k < charts_table[i].series_count && is_wanted(params, &charts_table[i]);
             k++)
            count += charts_table[i].series[k].count;
    return count;
}

enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 struct neph_progress *progress, struct neph_arena *arena,
                                 struct neph_chart **charts, int *count, struct neph_diag *diag)
{
    struct sweep sweep = {.store = store,
                          .progress = progress,
                          .repeats = params->repeats,
                          .time_limit_s = params->time_limit_s,
                          .device = params->device};
    *charts = neph_arena_zeroed(arena, CHART_COUNT, sizeof(**charts));
    enum neph_status status = neph_arena_check(arena, diag);
    for (size_t i = 0; i < CHART_COUNT && !status; i++) {
        if (!is_wanted(params, &charts_table[i]))
            continue;
        status = run_chart(&charts_table[i], &sweep, arena, &(*charts)[*count], diag);
        *count += !status;
    }
    return status ? status : neph_arena_check(arena, diag);
}

json_t *neph_chart_json(const struct neph_chart *chart)
{
    return json_pack("{s:s, s:s, s:s, s:s?, s:s?, s:O}", "id", chart->id, "title", chart->title,
                     "caption", chart->caption, "svg", chart->svg, "missing", chart->missing,
                     "spec", chart->spec);
}

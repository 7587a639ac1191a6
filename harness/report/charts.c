/* SPDX-License-Identifier: MIT
 *
 * Each point of a chart is a setting. Its error is the relative RMSE of radiance against `exact`;
 * its time is the time of a warm frame without start-up (harness/run/speed.h). The points of a
 * series are measured in turns, so that other load of the machine slows all of them equally. A
 * point has `repeats` renders, with different seeds for a stochastic engine: the chart shows the
 * median error with bars from the smallest to the largest.
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
#include "harness/run/benchmark.h"
#include "harness/run/job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { POINTS_MAX = 6, FLIGHT_ROUNDS = 4 };

static const double flight_round_s = 0.15; /* for each point */

/* A small size, so that a chart takes about a minute; mean errors do not depend on it. */
static const int chart_width_px = 48, chart_height_px = 27;

struct series {
    const char *name;
    const char *engine;
    const char *fixed;  /* a constant setting of the series; NULL: none */
    const char *varied; /* the setting that changes */
    double values[POINTS_MAX];
    int count;
    double order;    /* slope of the ideal line beside it: error ~ seconds^-order */
    bool is_by_work; /* values are sorted by increasing work */
};

static const struct series slab_series[] = {
    {"march: steps", "march", NULL, "steps", {2, 4, 8, 16, 32, 64}, 6, 2.0, true},
    {"Cycles: samples", "cycles", NULL, "samples", {4, 16, 64, 256}, 4, 0.5, true},
    {"POV-Ray: intervals", "povray", NULL, "intervals", {4, 8, 16, 32, 64}, 5, 2.0, true},
};
static const struct series fog_series[] = {
    {"march: steps", "march", NULL, "steps", {4, 8, 16, 32, 64, 128}, 6, 2.0, true},
    {"Cycles: samples", "cycles", NULL, "samples", {1, 4, 16, 64}, 4, 0.5, true},
    {"Cycles: step, 64 samples", "cycles", "samples=64", "step", {4, 2, 1, 0.5}, 4, 0.0, true},
    {"POV-Ray: intervals", "povray", NULL, "intervals", {4, 8, 16, 32, 64}, 5, 1.0, true},
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
    double error[NEPH_CHARTS_REPEATS_MAX], render_s[NEPH_CHARTS_REPEATS_MAX];
    struct neph_settings settings;
    struct neph_speed speed;
    char label[64];
};

/* The points of a series. Points without an error are removed at the end. */
struct measured {
    const struct series *series;
    const struct neph_engine *engine;
    struct neph_engine_info info;
    struct point points[POINTS_MAX];
};

struct sweep {
    const struct neph_scene *scene;
    struct neph_image *truth;
    struct neph_store *store;
    struct neph_times *times;
    struct neph_progress *progress;
    int repeats;
    double time_limit_s;
    struct neph_shared_device *device;
    json_t *points, *slopes, *falls; /* of one chart; owned */
    char absent[512];                /* text about the missing points */
};

static struct neph_job make_job(const struct sweep *sweep, const struct neph_engine *engine,
                                const struct neph_engine_info *info,
                                const struct neph_settings *settings, int repeat)
{
    return (struct neph_job){
        .engine = engine,
        .info = info,
        .repeat = repeat,
        .shot = {.scene = sweep->scene,
                 .settings = *settings,
                 .width_px = chart_width_px,
                 .height_px = chart_height_px,
                 .layers = NEPH_LAYER_RADIANCE,
                 .seed = (uint64_t)repeat + 1,
                 .time_limit_s = sweep->time_limit_s,
                 .device = sweep->device},
    };
}

static struct neph_job make_point_job(const struct sweep *sweep, const struct measured *measured,
                                      int index, int repeat)
{
    return make_job(sweep, measured->engine, &measured->info, &measured->points[index].settings,
                    repeat);
}

static enum neph_status relative_rmse(const struct sweep *sweep, const char *frame_path,
                                      double *error, struct neph_diag *diag)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS; /* irrelevant for linear errors */
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

/* ---- a series -------------------------------------------------------------------------------- */

static enum neph_status set_up(const struct sweep *sweep, const struct series *series,
                               struct measured *measured, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *measured = (struct measured){.series = series, .engine = neph_engine_find(series->engine)};
    neph_engine_probe(measured->engine, sweep->device, &measured->info);
    for (int i = 0; i < series->count && !status; i++) {
        struct point *point = &measured->points[i];
        point->settings = neph_settings_default(measured->engine);
        snprintf(point->label, sizeof(point->label), "%s=%g", series->varied, series->values[i]);
        if (series->fixed)
            status = neph_settings_set(measured->engine, &point->settings, series->fixed, diag);
        if (!status)
            status = neph_settings_set(measured->engine, &point->settings, point->label, diag);
    }
    return status;
}

static void begin_step(const struct sweep *sweep, const struct measured *measured, int index,
                       char what[160])
{
    snprintf(what, 160, "chart of %s: %s %s", sweep->scene->name, measured->engine->name,
             measured->points[index].label);
    neph_progress_begin(sweep->progress, what);
}

/* Render a point once, or read its frame from the store. */
static enum neph_status render_point(const struct sweep *sweep, struct measured *measured,
                                     int index, struct neph_diag *diag)
{
    struct point *point = &measured->points[index];
    const struct neph_job job = make_point_job(sweep, measured, index, point->repeats);
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    enum neph_status status = neph_job_run(&job, sweep->store, &result, diag);
    if (!status && result.outcome == NEPH_OUTCOME_RENDERED) {
        point->render_s[point->repeats] = result.cost.render_s;
        status = relative_rmse(sweep, result.frame_path, &point->error[point->repeats], diag);
        point->repeats += !status;
    }
    neph_job_result_finish(&result);
    return status;
}

/* Number of renders of a point. An engine with frames in flight is deterministic and timed
 * separately, so one render is enough. */
static int count_point_renders(const struct series *series, int repeats)
{
    return neph_flight_applies(neph_engine_find(series->engine)) ? 1 : repeats;
}

/* Render all points once before any point is repeated. */
static enum neph_status render_points(const struct sweep *sweep, struct measured *measured,
                                      struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int repeat = 0; repeat < count_point_renders(measured->series, sweep->repeats) && !status;
         repeat++)
        for (int i = 0; i < measured->series->count && !status; i++) {
            char what[160];
            const double start_s = neph_wall_s();
            begin_step(sweep, measured, i, what);
            if (measured->points[i].repeats == repeat)
                status = render_point(sweep, measured, i, diag);
            neph_progress_step(sweep->progress, what,
                               measured->points[i].repeats > repeat ? "rendered" : "not rendered",
                               neph_wall_s() - start_s);
        }
    return status;
}

/* ---- times of a series ----------------------------------------------------------------------- */

/* Time frames in flight in rounds, one point after the other. */
static enum neph_status fly_points(const struct sweep *sweep, struct measured *measured,
                                   struct neph_diag *diag)
{
    struct neph_speed_flight flights[POINTS_MAX] = {{.picture = 0}};
    const int count = measured->series->count;
    enum neph_status status = NEPH_OK;
    neph_progress_begin(sweep->progress, "times of a chart");
    for (int i = 0; i < count && !status; i++) {
        const struct neph_job job = make_point_job(sweep, measured, i, 0);
        if (measured->points[i].repeats > 0)
            status = neph_speed_flight_open(&job, &flights[i], diag);
    }
    for (int round = 0; round < FLIGHT_ROUNDS && !status; round++)
        for (int i = 0; i < count && !status; i++)
            if (flights[i].job.engine)
                status = neph_speed_flight_round(&flights[i], flight_round_s, diag);
    for (int i = 0; i < count; i++) {
        const struct neph_job job = make_point_job(sweep, measured, i, 0);
        if (!status && flights[i].job.engine) {
            measured->points[i].speed = neph_speed_from_flight(&flights[i]);
            status = neph_speed_keep(sweep->times, &job, &measured->points[i].speed, diag);
        }
        neph_speed_flight_close(&flights[i]);
    }
    return status;
}

/* Reuse cached times only when all points have one: times of two runs were measured under different
 * load. */
static enum neph_status time_flights(const struct sweep *sweep, struct measured *measured,
                                     struct neph_diag *diag)
{
    bool all = true;
    for (int i = 0; i < measured->series->count; i++) {
        const struct neph_job job = make_point_job(sweep, measured, i, 0);
        all = all && (measured->points[i].repeats == 0 ||
                      neph_speed_find(sweep->times, &job, &measured->points[i].speed));
    }
    return all ? NEPH_OK : fly_points(sweep, measured, diag);
}

/* Start-up time of a renderer: the intercept of a line through the render times over the number of
 * samples. */
static double start_by_samples(const struct measured *measured)
{
    int samples[POINTS_MAX], count = 0;
    double mean_s[POINTS_MAX], least_s[POINTS_MAX];
    for (int i = 0; i < measured->series->count; i++) {
        const struct point *point = &measured->points[i];
        if (point->repeats == 0)
            continue;
        samples[count] = (int)measured->series->values[i];
        mean_s[count] = least_s[count] = point->render_s[0];
        for (int k = 1; k < point->repeats; k++) {
            mean_s[count] += point->render_s[k];
            least_s[count] = fmin(least_s[count], point->render_s[k]);
        }
        mean_s[count++] /= point->repeats;
    }
    return neph_sample_levels_start_time(samples, mean_s, least_s, count);
}

/* Times of whole renders without start-up. The start-up follows from the render times when the
 * series varies the samples, otherwise from the render of a small frame. */
static enum neph_status time_renders(const struct sweep *sweep, struct measured *measured,
                                     struct neph_diag *diag)
{
    const int first = 0, last = measured->series->count - 1;
    const struct point *least = &measured->points[first], *most = &measured->points[last];
    const bool is_by_samples = strcmp(measured->series->varied, "samples") == 0;
    double process_s = NAN, in_render_s = NAN;
    if (least->repeats == 0 || most->repeats == 0)
        return NEPH_OK;
    const struct neph_job job = make_point_job(sweep, measured, last, 0);
    const enum neph_status status = neph_speed_start(&job, most->render_s[0], sweep->store,
                                                     &process_s, &in_render_s, diag);
    if (is_by_samples)
        in_render_s = start_by_samples(measured);
    for (int i = 0; i <= last && !status; i++)
        measured->points[i].speed = neph_speed_from_renders(
            measured->points[i].render_s, measured->points[i].repeats, process_s, in_render_s);
    return status;
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* `place` is the index of the setting in its series; the chart joins points in this order. */
static json_t *point_json(const struct series *series, const struct point *point, int place)
{
    const int middle = point->repeats / 2, last = point->repeats - 1;
    const struct neph_speed *speed = &point->speed;
    const bool is_timed = neph_speed_is_measured(speed);
    json_t *json = json_pack("{s:s, s:s, s:s, s:i, s:o, s:o, s:o, s:f, s:f, s:f, s:s}", "series",
                             series->name, "engine", series->engine, "label", point->label, "place",
                             place, "seconds", is_timed ? json_real(speed->render_s) : json_null(),
                             "seconds_low", is_timed ? json_real(speed->low_s) : json_null(),
                             "seconds_high", is_timed ? json_real(speed->high_s) : json_null(),
                             "error", point->error[middle], "error_low", point->error[0],
                             "error_high", point->error[last], "unit", "relative RMSE of radiance");
    neph_json_set(&json, "speed", neph_speed_json(speed));
    return json;
}

/* Add the ideal line of a series. It starts at half the error of the first point and ends at the
 * time of the last point. */
static void add_slope(struct sweep *sweep, const struct series *series, const struct point *first,
                      const struct point *last)
{
    if (series->order <= 0.0)
        return;
    const double start_s = first->speed.render_s, end_s = last->speed.render_s;
    const double error = 0.5 * first->error[first->repeats / 2];
    char line[96];
    if (!(start_s > 0.0 && end_s > 0.0))
        return;
    snprintf(line, sizeof(line), "%s: error ~ 1/time^%g", series->engine, series->order);
    neph_json_add(&sweep->slopes,
                  json_pack("{s:s, s:f, s:f}", "line", line, "seconds", start_s, "error", error));
    neph_json_add(&sweep->slopes, json_pack("{s:s, s:f, s:f}", "line", line, "seconds", end_s,
                                            "error", error * pow(end_s / start_s, -series->order)));
}

/* Report points with more work and less time: such times are a fault of the measurement. */
static void check_order(struct sweep *sweep, const struct measured *measured)
{
    struct neph_speed speeds[POINTS_MAX];
    int earlier;
    for (int i = 0; i < measured->series->count; i++)
        speeds[i] = measured->points[i].speed;
    const int later = neph_speed_find_inversion(speeds, measured->series->count, &earlier);
    if (later < 0 || !measured->series->is_by_work)
        return;
    char text[256];
    snprintf(text, sizeof(text),
             "%s: %s took less time than %s, beyond their intervals; the machine was busy with "
             "something else, so these times are no measurement",
             measured->series->name, measured->points[later].label,
             measured->points[earlier].label);
    neph_json_add(&sweep->falls, json_string(text));
}

static void add_series(struct sweep *sweep, struct measured *measured)
{
    const struct series *series = measured->series;
    const struct point *first = NULL, *last = NULL;
    int count = 0;
    for (int i = 0; i < series->count; i++) {
        struct point *point = &measured->points[i];
        if (point->repeats == 0)
            continue;
        neph_sort_doubles(point->error, (size_t)point->repeats);
        neph_json_add(&sweep->points, point_json(series, point, i));
        first = first ? first : point;
        last = point;
        count++;
    }
    if (count >= 2)
        add_slope(sweep, series, first, last);
    if (count < series->count) {
        const size_t used = strlen(sweep->absent);
        snprintf(sweep->absent + used, sizeof(sweep->absent) - used,
                 " %s: %d of %d points not rendered.", series->name, series->count - count,
                 series->count);
    }
}

static enum neph_status run_series(struct sweep *sweep, const struct series *series,
                                   struct neph_diag *diag)
{
    struct measured measured;
    enum neph_status status = set_up(sweep, series, &measured, diag);
    if (!status)
        status = render_points(sweep, &measured, diag);
    if (!status)
        status = neph_flight_applies(measured.engine) ? time_flights(sweep, &measured, diag)
                                                      : time_renders(sweep, &measured, diag);
    if (status)
        return status;
    check_order(sweep, &measured);
    add_series(sweep, &measured);
    return NEPH_OK;
}

static enum neph_status render_truth(struct sweep *sweep, struct neph_diag *diag)
{
    const struct neph_engine *exact = neph_engine_find("exact");
    struct neph_engine_info info;
    neph_engine_probe(exact, sweep->device, &info);
    const struct neph_settings settings = neph_settings_default(exact);
    const struct neph_job job = make_job(sweep, exact, &info, &settings, 0);
    struct neph_cost cost;
    return neph_job_render(&job, &sweep->truth, &cost, diag);
}

/* The caption: scene and size, repeats, missing points. */
static const char *make_caption(const struct chart *chart, const struct sweep *sweep,
                                struct neph_arena *arena)
{
    char runs[160] = "One render of each point: its time is not measured.";
    if (sweep->repeats > 1)
        snprintf(
            runs, sizeof(runs),
            "Errors: middle of %d renders (other seeds where the engine draws random numbers), "
            "bars from the smallest to the largest.",
            sweep->repeats);
    return neph_arena_format(
        arena,
        "Scene %s at %dx%d px against exact. Times of warm frames, start-up apart: of frames in "
        "flight the median, bars from 10 %% to 90 %%; of whole renders the mean, bars its 95 %% "
        "interval. %s A point without error or time is not drawn.%s",
        chart->scene, chart_width_px, chart_height_px, runs, sweep->absent);
}

/* Fill the specification with the points of all series. */
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
    sweep->falls = json_array();
    sweep->absent[0] = '\0';
    if (!status)
        status = render_truth(sweep, diag);
    if (!status)
        status = fill_spec(chart, sweep, spec, diag);
    if (!status)
        *made = (struct neph_chart){.id = chart->id,
                                    .title = chart->title,
                                    .caption = make_caption(chart, sweep, arena),
                                    .spec = json_incref(spec),
                                    .falls = json_incref(sweep->falls)};
    json_decref(sweep->points);
    json_decref(sweep->slopes);
    json_decref(sweep->falls);
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
            count += charts_table[i].series[k].count *
                     count_point_renders(&charts_table[i].series[k], params->repeats);
    return count;
}

enum neph_status neph_charts_run(const struct neph_charts_params *params, struct neph_store *store,
                                 struct neph_progress *progress, struct neph_arena *arena,
                                 struct neph_chart **charts, int *count, struct neph_diag *diag)
{
    struct sweep sweep = {.store = store,
                          .times = params->times,
                          .progress = progress,
                          .repeats = params->repeats,
                          .time_limit_s = params->time_limit_s,
                          .device = params->device};
    *charts = neph_arena_allocate(arena, CHART_COUNT, sizeof(**charts));
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
    return json_pack("{s:s, s:s, s:s, s:s?, s:s?, s:O, s:O?}", "id", chart->id, "title",
                     chart->title, "caption", chart->caption, "svg", chart->svg, "missing",
                     chart->missing, "spec", chart->spec, "times_fall", chart->falls);
}

/* SPDX-License-Identifier: MIT
 *
 * Sweeps without rendering: plans and refused plans, fronts, positions of labels, and data of
 * charts. The table of keys in docs/sweep.md is printed from the fields; `test_sweep --write`
 * writes it.
 */
#include "tests/printed_table.h"

#include "harness/engines/engines.h"
#include "harness/sweep/chart.h"
#include "harness/sweep/equal.h"
#include "harness/sweep/front.h"
#include "harness/sweep/labels.h"
#include "harness/sweep/output.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* --- plans ---------------------------------------------------------------------------------- */

#define HEAD                                                                                       \
    "title: a plan\nlight: octaves\nwidth_px: 32\nheight_px: 18\nframes: 32\nwarm_up: 16\n"        \
    "truth_samples: 16\nrounds: 2\nseries:\n"

static enum neph_status load(const char *text, struct neph_sweep_plan *plan, struct neph_diag *diag)
{
    char path[] = "/tmp/neph_test_sweep_XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, strlen(text)), strlen(text));
    close(fd);
    const enum neph_status status = neph_sweep_plan_load(path, plan, diag);
    unlink(path);
    return status;
}

static void test_a_plan_is_read(void **state)
{
    struct neph_sweep_plan plan;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(load(HEAD "- {name: a, engine: march, vary: steps, values: 4 8  16}\n"
                             "- {name: b, engine: realtime, preset: ours+taa=off, set: steps=8, "
                             "flicker: true}\n"
                             "- {name: c, engine: realtime, vary: steps, values: 4 8, lag_at: 8, "
                             "scattering: single}\n",
                        &plan, &diag),
                   &diag);
    char label[NEPH_SWEEP_LABEL_SIZE];
    assert_int_equal(plan.series_count, 3);
    assert_int_equal(neph_sweep_value_count(&plan.series[0]), 3);
    assert_int_equal(neph_sweep_value_count(&plan.series[1]), 1);
    neph_sweep_value(&plan.series[0], 2, label);
    assert_string_equal(label, "steps=16");
    neph_sweep_value(&plan.series[1], 0, label);
    assert_string_equal(label, "");
    assert_true(plan.series[1].flicker && !plan.series[0].flicker);
    assert_false(neph_sweep_has_lag(&plan.series[2], 0));
    assert_true(neph_sweep_has_lag(&plan.series[2], 1));
    const struct neph_scene scene = {.scattering = NEPH_SCATTERING_MULTIPLE};
    assert_int_equal(neph_sweep_scattering(&plan.series[0], &scene), NEPH_SCATTERING_MULTIPLE);
    assert_int_equal(neph_sweep_scattering(&plan.series[2], &scene), NEPH_SCATTERING_SINGLE);
    neph_sweep_plan_finish(&plan);
}

/* The light of a plan applies to scenes with all orders of scattering, and to series without it. */
static void test_the_light_is_that_of_the_scene(void **state)
{
    struct neph_sweep_plan plan;
    struct neph_diag diag = {.line = 0};
    struct neph_settings single, multiple;
    const struct neph_engine *realtime = neph_engine_find("realtime");
    neph_assert_ok(load(HEAD "- {name: a, engine: march}\n- {name: b, engine: realtime}\n"
                             "- {name: c, engine: realtime, set: lighting=traced}\n",
                        &plan, &diag),
                   &diag);
    assert_string_equal(neph_sweep_engine(&plan, &plan.series[0], NEPH_SCATTERING_SINGLE)->name,
                        "march");
    assert_string_equal(neph_sweep_engine(&plan, &plan.series[0], NEPH_SCATTERING_MULTIPLE)->name,
                        "march_octaves");
    static const char *const wanted[] = {"octaves", "traced"};
    for (int s = 1; s < 3; s++) {
        neph_assert_ok(
            neph_sweep_settings(&plan, &plan.series[s], 0, NEPH_SCATTERING_SINGLE, &single, &diag),
            &diag);
        neph_assert_ok(neph_sweep_settings(&plan, &plan.series[s], 0, NEPH_SCATTERING_MULTIPLE,
                                           &multiple, &diag),
                       &diag);
        const int lighting = neph_option_find(realtime->options, "lighting");
        assert_string_equal(realtime->options[lighting].choices[(int)multiple.values[lighting]],
                            wanted[s - 1]);
        if (s == 1)
            assert_true(single.values[lighting] == 0.0);
    }
    neph_sweep_plan_finish(&plan);
}

/* `sky` of an engine's settings after adaptation to a catalogue scene: 0 is off, -1: no such
 * setting. */
static double sky_met(const char *scene_name, const char *engine_name, const char *word)
{
    const struct neph_engine *engine = neph_engine_find(engine_name);
    struct neph_settings settings = neph_settings_default(engine);
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    char path[512];
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/catalog/%s.yaml", scene_name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    if (word)
        neph_assert_ok(neph_settings_set(engine, &settings, word, &diag), &diag);
    neph_settings_adapt_to_scene(engine, scene, &settings);
    neph_scene_destroy(scene);
    const int sky = neph_option_find(engine->options, "sky");
    return sky < 0 ? -1.0 : settings.values[sky];
}

/* Engines that refuse coloured air as a medium get tables of it. No other case does: an engine that
 * marches the air, a scene without air, an engine without tables. */
static void test_air_comes_from_tables_where_it_must(void **state)
{
    assert_true(sky_met("sky_earth", "realtime", "lighting=octaves") == 1.0);
    assert_true(sky_met("sky_earth", "march_traced", NULL) == 1.0);
    assert_true(sky_met("sky_earth", "march_octaves", NULL) == 0.0);
    assert_true(sky_met("coloured_fog", "realtime", NULL) == 0.0);
    assert_true(sky_met("gaussian_blob", "realtime", NULL) == 0.0);
    assert_true(sky_met("sky_earth", "tracer", NULL) == -1.0);
}

/* Each with a part of the message. */
static void test_bad_plans_are_refused(void **state)
{
    static const struct {
        const char *text, *said;
    } bad[] = {
        {HEAD "- {name: a, engine: marsh}\n", "no engine 'marsh'"},
        {HEAD "- {name: a, engine: march, vary: steps}\n", "need each other"},
        {HEAD "- {name: a, engine: march, values: 3 4}\n", "need each other"},
        {HEAD "- {name: a, engine: march, vary: stepps, values: 4}\n", "stepps"},
        {HEAD "- {name: a, engine: march, vary: steps, values: 0}\n", "1..65536"},
        {HEAD "- {name: a, engine: march, vary: steps, values: 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 "
              "1}\n",
         "1 to 16 values"},
        {HEAD "- {name: a, engine: march}\n- {name: a, engine: tracer}\n", "a second series"},
        {HEAD "- {name: a, engine: realtime, preset: mine}\n", "mine"},
        {HEAD "- {name: a, engine: march, colour: red}\n", "colour"},
        {HEAD, "series"},
        {"title: a plan\nlight: candle\nwidth_px: 32\nheight_px: 18\nframes: 32\nwarm_up: 16\n"
         "truth_samples: 16\nrounds: 2\nseries:\n- {name: a, engine: march}\n",
         "no light 'candle'"},
        {"title: a plan\nlight: octaves\nwidth_px: 32\nheight_px: 18\nframes: 32\nwarm_up: 20\n"
         "truth_samples: 16\nrounds: 2\nseries:\n- {name: a, engine: march}\n",
         "fewer than 16 of 32"},
        {"title: a plan\nlight: octaves\nwidth_px: 32\nheight_px: 18\nframes: 33\nwarm_up: 16\n"
         "truth_samples: 16\nrounds: 2\nseries:\n- {name: a, engine: march}\n",
         "no multiple of 4"},
    };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct neph_sweep_plan plan;
        struct neph_diag diag = {.line = 0};
        assert_int_equal(load(bad[i].text, &plan, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, bad[i].said))
            fail_msg("'%s' does not say '%s'", diag.message, bad[i].said);
    }
}

static void test_the_plans_that_come_with_neph(void **state)
{
    struct neph_sweep_plan plan;
    struct neph_diag diag = {.line = 0};
    static const struct {
        const char *name;
        int least_points;
    } plans[] = {{"steps", 12},    {"sweep", 30},    {"sweep_gpu", 30},
                 {"textures", 20}, {"shadows", 13},  {"froxels", 20},
                 {"sky", 20},      {"fog_look", 12}, {"shortcuts", 27}};
    for (size_t n = 0; n < sizeof(plans) / sizeof(plans[0]); n++) {
        int points = 0;
        neph_assert_ok(neph_sweep_plan_load(plans[n].name, &plan, &diag), &diag);
        for (int i = 0; i < plan.series_count; i++)
            points += neph_sweep_value_count(&plan.series[i]);
        assert_true(points >= plans[n].least_points);
        neph_sweep_plan_finish(&plan);
    }
    assert_int_equal(neph_sweep_plan_load("no_such_plan", &plan, &diag), NEPH_ERR_NOT_FOUND);
}

static void test_the_manual_has_the_keys(void **state)
{
    const struct printed_table table = {NEPH_SOURCE_DIR "/docs/sweep.md",
                                        "<!-- written by tests/test_sweep --write -->\n"
                                        "| key | value | default | meaning |\n"
                                        "| --- | --- | --- | --- |\n",
                                        "<!-- end -->\n", neph_sweep_plan_print_keys};
    check_readme(&table, *state);
}

/* --- fronts --------------------------------------------------------------------------------- */

static void test_a_front(void **state)
{
    struct neph_front_point points[] = {{{1, 9}, false}, {{2, 5}, false}, {{2, 5}, false},
                                        {{3, 6}, false}, {{9, 1}, false}, {{NAN, 0}, false},
                                        {{2, 7}, false}};
    static const bool wanted[] = {true, true, true, false, true, false, false};
    neph_front_find(points, 7, 2);
    for (int i = 0; i < 7; i++)
        assert_int_equal(points[i].on_front, wanted[i]);
}

/* By definition, on random points with many ties. */
static void test_fronts_of_random_points(void **state)
{
    uint64_t seed = 20261124;
    for (int trial = 0; trial < 50; trial++) {
        struct neph_front_point points[40];
        for (int i = 0; i < 40; i++)
            for (int a = 0; a < 3; a++)
                points[i].values[a] = floor(neph_test_uniform(&seed, 0.0, 6.0));
        neph_front_find(points, 40, 3);
        for (int i = 0; i < 40; i++) {
            bool is_beaten = false;
            for (int k = 0; k < 40; k++) {
                const double *a = points[k].values, *b = points[i].values;
                is_beaten |= a[0] <= b[0] && a[1] <= b[1] && a[2] <= b[2] &&
                             a[0] + a[1] + a[2] < b[0] + b[1] + b[2];
            }
            assert_int_equal(points[i].on_front, !is_beaten);
        }
    }
}

/* --- labels --------------------------------------------------------------------------------- */

/* Whether the label meets a box around a centre. */
static bool name_meets(const struct neph_label *label, double x_px, double y_px, double width_px,
                       double height_px)
{
    const double middle = label->x_px + label->dx_px + 0.5 * label->width_px;
    return fabs(middle - x_px) < 0.5 * (label->width_px + width_px) &&
           fabs(label->y_px + label->dy_px - y_px) < 0.5 * (NEPH_LABEL_HEIGHT_PX + height_px);
}

static bool names_meet(const struct neph_label *a, const struct neph_label *b)
{
    return name_meets(a, b->x_px + b->dx_px + 0.5 * b->width_px, b->y_px + b->dy_px, b->width_px,
                      NEPH_LABEL_HEIGHT_PX);
}

/* Labels marked clear overlap neither each other nor marks; of ten among thirty marks nearly all
 * are clear. */
static void test_names_lie_on_nothing(void **state)
{
    uint64_t seed = 20261124;
    int clear = 0;
    enum { MARKS = 30, TRIALS = 40 };
    for (int trial = 0; trial < TRIALS; trial++) {
        struct neph_label labels[MARKS];
        for (int i = 0; i < MARKS; i++)
            labels[i] = (struct neph_label){.x_px = neph_test_uniform(&seed, 0.0, 600.0),
                                            .y_px = neph_test_uniform(&seed, 0.0, 400.0),
                                            .width_px = i % 3 ? 0.0 : 60.0};
        const struct neph_label_plot plot = {600.0, 400.0, 14.0, NULL, 0};
        neph_labels_place(labels, MARKS, &plot);
        for (int i = 0; i < MARKS; i++) {
            if (!labels[i].is_clear)
                continue;
            clear++;
            for (int k = 0; k < MARKS; k++) {
                const double side_px = 2.0 * NEPH_MARK_RADIUS_PX;
                assert_false(
                    name_meets(&labels[i], labels[k].x_px, labels[k].y_px, side_px, side_px));
                assert_false(k != i && labels[k].width_px > 0.0 && labels[k].is_clear &&
                             names_meet(&labels[i], &labels[k]));
            }
        }
    }
    assert_true(clear > (9 * TRIALS * MARKS / 3) / 10);
}

/* The label takes a position without a line if another differs only by a line. A label far from
 * its mark gets a leader line. */
static void test_names_keep_off_lines(void **state)
{
    const struct neph_label_line line = {100.0, 100.0, 300.0, 100.0};
    const struct neph_label_plot plot = {600.0, 400.0, 0.0, &line, 1};
    struct neph_label label = {.x_px = 100.0, .y_px = 100.0, .width_px = 60.0};
    neph_labels_place(&label, 1, &plot);
    assert_true(label.is_clear && !label.is_apart);
    assert_true(fabs(label.dy_px) >= 0.5 * NEPH_LABEL_HEIGHT_PX || label.dx_px < -60.0);
    struct neph_label crowd[26] = {[0] = {.x_px = 300.0, .y_px = 200.0}}; /* the last is inside */
    for (int i = 0; i < 25; i++)
        crowd[i] = (struct neph_label){.x_px = 250.0 + 25.0 * (i % 5),
                                       .y_px = 176.0 + 12.0 * (i / 5)};
    crowd[25] = (struct neph_label){.x_px = 300.0, .y_px = 200.0, .width_px = 40.0};
    neph_labels_place(crowd, 26, &plot);
    assert_true(crowd[25].is_apart);
    const double right = 300.0 + crowd[25].dx_px + 40.0, left = 300.0 + crowd[25].dx_px;
    assert_true(crowd[25].lead_x_px >= left - 3.0 && crowd[25].lead_x_px <= right + 3.0);
}

/* --- charts and JSON ------------------------------------------------------------------------ */

enum { POINTS = 4 };

/* Two series of two points; one point was not rendered, one has a flicker of 0. */
struct made {
    struct neph_sweep_plan plan;
    struct neph_sweep_point points[POINTS];
    struct neph_scene scene;
    struct neph_engine_info info;
    struct neph_sweep sweep;
};

static void make_sweep(struct made *made)
{
    struct neph_diag diag = {.line = 0};
    struct neph_sweep_point *points = made->points;
    made->scene = (struct neph_scene){.name = "made"};
    made->info = (struct neph_engine_info){.device = "a device", .version = "1"};
    neph_assert_ok(load(HEAD "- {name: one, engine: march, vary: steps, values: 4 8, order: 1}\n"
                             "- {name: two, engine: tracer, vary: samples, values: 4 8}\n",
                        &made->plan, &diag),
                   &diag);
    made->sweep = (struct neph_sweep){.plan = &made->plan,
                                      .scene = &made->scene,
                                      .points = points,
                                      .point_count = POINTS,
                                      .truth = "exact",
                                      .mask = "all",
                                      .clear_of = "all"};
    for (int i = 0; i < POINTS; i++) {
        points[i] = (struct neph_sweep_point){
            .series = &made->plan.series[i / 2],
            .place = i % 2,
            .settings = "",
            .evaluations = NAN,
            .job = {.engine = neph_engine_find(i < 2 ? "march" : "tracer"), .info = &made->info},
            .time = {0.01 * (i + 1), 0.009 * (i + 1), 0.012 * (i + 1)}};
        for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
            points[i].numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
        points[i].numbers[NEPH_SWEEP_ERROR] = (struct neph_sweep_value){0.1 / (i + 1), NAN, NAN};
        points[i].job.shot.scene = &made->scene;
        points[i].job.shot.settings = neph_settings_default(points[i].job.engine);
        neph_sweep_value(points[i].series, points[i].place, points[i].label);
    }
    snprintf(points[3].missing, sizeof(points[3].missing), "not here");
    points[0].numbers[NEPH_SWEEP_FLICKER].value = 0.0;
}

static void test_charts_have_the_measurements(void **state)
{
    struct made made;
    struct neph_diag diag = {.line = 0};
    make_sweep(&made);
    json_t *spec = NULL;
    neph_assert_ok(neph_sweep_chart_spec(&made.sweep, &neph_sweep_charts[0],
                                         &neph_sweep_chart_sizes[0], &spec, &diag),
                   &diag);
    const json_t *data = json_object_get(spec, "datasets");
    assert_int_equal(json_array_size(json_object_get(data, "points")), 3);
    assert_int_equal(json_array_size(json_object_get(data, "labels")), 2);
    assert_int_equal(json_array_size(json_object_get(data, "front")), 3 + 2); /* and two ends */
    /* From the upper edge down to the first, by x, and to the right edge: never up again. */
    const json_t *front = json_object_get(data, "front");
    for (int i = 0; i < 5; i++) {
        const json_t *at = json_array_get(front, (size_t)i), *next = json_array_get(front, i + 1);
        assert_int_equal(json_integer_value(json_object_get(at, "place")), i);
        if (next)
            assert_true(json_number_value(json_object_get(next, "x")) >=
                            json_number_value(json_object_get(at, "x")) &&
                        json_number_value(json_object_get(next, "y")) <=
                            json_number_value(json_object_get(at, "y")));
    }
    const json_t *slopes = json_object_get(data, "slopes");
    assert_int_equal(json_array_size(slopes), 2);
    const double first = json_number_value(json_object_get(json_array_get(slopes, 0), "y"));
    const double last = json_number_value(json_object_get(json_array_get(slopes, 1), "y"));
    assert_true(fabs(first / last - 2.0) < 1e-12); /* twice the time, order 1 */
    json_decref(spec);
    for (const struct neph_sweep_chart *chart = neph_sweep_charts; chart->id; chart++)
        if (chart->y == NEPH_SWEEP_FLICKER) { /* its only point is not on the axis */
            neph_assert_ok(
                neph_sweep_chart_spec(&made.sweep, chart, &neph_sweep_chart_sizes[0], &spec, &diag),
                &diag);
            assert_null(spec);
        }
    neph_sweep_plan_finish(&made.plan);
}

static const json_t *make_floors(const struct made *made, json_t **spec)
{
    const struct neph_sweep_chart *chart = neph_sweep_charts;
    struct neph_diag diag = {.line = 0};
    while (strcmp(chart->id, "time_flicker") != 0)
        chart++;
    neph_assert_ok(
        neph_sweep_chart_spec(&made->sweep, chart, &neph_sweep_chart_sizes[0], spec, &diag), &diag);
    return json_object_get(json_object_get(*spec, "datasets"), "floor");
}

/* A line for each floor at the last point of a series, within the axis; floors that are equal to
 * half a percent share it. */
static void test_charts_have_floors(void **state)
{
    struct made made;
    json_t *spec = NULL;
    make_sweep(&made);
    for (int i = 0; i < 3; i++) {
        made.points[i].numbers[NEPH_SWEEP_FLICKER].value = 2.0 + i;
        for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
            made.points[i].floors[n] = NAN;
    }
    assert_int_equal(json_array_size(make_floors(&made, &spec)), 0);
    json_decref(spec);
    made.points[0].floors[NEPH_SWEEP_FLICKER] = 1.5; /* not the last of its series */
    made.points[1].floors[NEPH_SWEEP_FLICKER] = 0.25;
    made.points[2].floors[NEPH_SWEEP_FLICKER] = 0.251; /* closer than a line is thick */
    const json_t *floors = make_floors(&made, &spec), *first = json_array_get(floors, 0);
    assert_int_equal(json_array_size(floors), 1);
    assert_string_equal(neph_json_text(first, "text"), "floor of one, two");
    assert_true(neph_json_real(first, "y") == 0.25);
    json_decref(spec);
    made.points[2].floors[NEPH_SWEEP_FLICKER] = 0.5;
    floors = make_floors(&made, &spec);
    assert_int_equal(json_array_size(floors), 2);
    assert_string_equal(neph_json_text(json_array_get(floors, 1), "text"), "floor of two");
    json_decref(spec);
    neph_sweep_plan_finish(&made.plan);
}

/* Compares series with one of them: returns the count, and the first comparison. */
static int hold(const struct made *made, int base, enum neph_sweep_cost cost,
                struct neph_sweep_comparison *first)
{
    struct neph_sweep_comparison list[NEPH_SWEEP_SERIES_MAX];
    const int count = neph_sweep_compare_series(&made->sweep, &made->plan.series[base], cost,
                                                NEPH_SWEEP_ERROR, list);
    *first = list[0];
    return count;
}

/* Half the error in twice the time, whatever the order of the points. */
static void test_equal_error_and_equal_time(void **state)
{
    const double time_s[] = {4, 1, 16}, error[] = {0.25, 1, 0.0625};
    assert_true(fabs(neph_sweep_interpolate(time_s, error, 3, 2.0) - 0.5) < 1e-12);
    assert_true(fabs(neph_sweep_interpolate(error, time_s, 3, 0.125) - 8.0) < 1e-12);
    assert_true(fabs(neph_sweep_interpolate(time_s, error, 3, 16.0) - 0.0625) < 1e-12);
    assert_true(isnan(neph_sweep_interpolate(time_s, error, 3, 17.0)));
    assert_true(isnan(neph_sweep_interpolate(time_s, error, 3, 0.9)));
    struct made made;
    make_sweep(&made);
    struct neph_sweep_point *points = made.points;
    struct neph_sweep_comparison held;
    points[2].numbers[NEPH_SWEEP_ERROR].value = 0.05; /* the second point's, in 0.03 s */
    assert_int_equal(hold(&made, 0, NEPH_SWEEP_COST_TIME, &held), 1);
    assert_ptr_equal(held.series, &made.plan.series[1]);
    assert_true(fabs(held.cost_ratio - 1.5) < 1e-12);
    assert_true(isnan(held.number_ratio)); /* 0.03 s are beyond 0.02 s */
    /* A single point is compared only at an equal error or an equal cost. */
    assert_int_equal(hold(&made, 1, NEPH_SWEEP_COST_TIME, &held), 1);
    assert_true(fabs(held.cost_ratio - 2.0 / 3.0) < 1e-12 && isnan(held.number_ratio));
    points[2].numbers[NEPH_SWEEP_ERROR].value = 0.04;
    assert_int_equal(hold(&made, 1, NEPH_SWEEP_COST_TIME, &held), 0);
    /* A series is compared by the best of its comparable points. */
    points[1].time.median = 0.03;
    assert_int_equal(hold(&made, 0, NEPH_SWEEP_COST_TIME, &held), 1);
    assert_true(isnan(held.cost_ratio) && fabs(held.number_ratio - 0.8) < 1e-12);
    points[1].time.median = 0.02;
    points[2].numbers[NEPH_SWEEP_ERROR].value = 0.05;
    /* Evaluations were not counted; once they are, they are another cost. */
    assert_int_equal(hold(&made, 0, NEPH_SWEEP_COST_WORK, &held), 0);
    for (int i = 0; i < POINTS; i++)
        points[i].evaluations = 10.0 * (i + 1);
    points[2].evaluations = 15.0;
    assert_int_equal(hold(&made, 0, NEPH_SWEEP_COST_WORK, &held), 1);
    assert_true(fabs(held.cost_ratio - 0.75) < 1e-12);          /* 15 of 20 for the same error */
    assert_true(fabs(held.number_ratio - 0.05 * 15.0) < 1e-12); /* which is 0.1 * 10 / 15 there */
    json_t *json = neph_sweep_equals_json(&made.sweep);
    assert_int_equal(json_array_size(json), 2); /* by time and by evaluations */
    json_decref(json);
    neph_sweep_plan_finish(&made.plan);
}

static void test_json_has_every_point(void **state)
{
    struct made made;
    make_sweep(&made);
    json_t *json = neph_sweep_json(&made.sweep);
    assert_non_null(json);
    assert_int_equal(json_integer_value(json_object_get(json, "measured")), 3);
    assert_int_equal(json_integer_value(json_object_get(json, "expected")), POINTS);
    const json_t *list = json_object_get(json, "points");
    assert_int_equal(json_array_size(list), POINTS);
    assert_string_equal(neph_json_text(json_array_get(list, 3), "missing"), "not here");
    const char *command = neph_json_text(json_array_get(list, 0), "command");
    assert_string_equal(command, "neph render made -e march --size 32x18 --seed 0");
    json_decref(json);
    neph_sweep_plan_finish(&made.plan);
}

int main(int count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_plan_is_read),
        cmocka_unit_test(test_the_light_is_that_of_the_scene),
        cmocka_unit_test(test_air_comes_from_tables_where_it_must),
        cmocka_unit_test(test_bad_plans_are_refused),
        cmocka_unit_test(test_the_plans_that_come_with_neph),
        cmocka_unit_test_prestate(test_the_manual_has_the_keys, writes_readme(count, arguments)),
        cmocka_unit_test(test_a_front),
        cmocka_unit_test(test_fronts_of_random_points),
        cmocka_unit_test(test_names_lie_on_nothing),
        cmocka_unit_test(test_names_keep_off_lines),
        cmocka_unit_test(test_charts_have_the_measurements),
        cmocka_unit_test(test_charts_have_floors),
        cmocka_unit_test(test_equal_error_and_equal_time),
        cmocka_unit_test(test_json_has_every_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

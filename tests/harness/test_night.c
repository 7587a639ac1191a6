/* SPDX-License-Identifier: MIT
 *
 * Nightly runs without renderers: reading of results, order of steps, and findings in histories
 * with known answers.
 */
#include "tests/harness/image_test.h"
#include "tests/harness/store_test.h"

#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/night/compare.h"
#include "harness/night/readers.h"
#include "harness/run/history.h"
#include "harness/sweep/plan.h"

static const double alpha = 0.005;

/* ---- steps ----------------------------------------------------------------------------------- */

static void make_plan(struct neph_arena *arena, const char *tier, const char *only,
                      struct neph_night_plan *plan)
{
    struct neph_diag diag = {0};
    const struct neph_night_plan_params params = {
        .tier = tier, .only = &only, .only_count = only ? 1 : 0};
    neph_assert_ok(neph_night_plan_make(&params, arena, plan, &diag), &diag);
}

/* The full tier measures the series of the quick tier under the same names and with the same
 * commands. */
static void test_the_full_tier_goes_on_with_the_series_of_the_quick_one(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_plan quick, full;
    make_plan(&arena, "quick", NULL, &quick);
    make_plan(&arena, "full", NULL, &full);
    assert_true(quick.count > 8 && full.count > 5 * quick.count);
    for (int i = 0; i < quick.count; i++) {
        assert_string_equal(quick.steps[i].name, full.steps[i].name);
        for (int w = 0; quick.steps[i].words[w]; w++)
            assert_string_equal(quick.steps[i].words[w], full.steps[i].words[w]);
    }
    for (int i = 0; i < full.count; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(full.steps[i].name, full.steps[k].name);
    neph_arena_finish(&arena);
}

static bool has_series(const struct neph_sweep_plan *plan, const char *name)
{
    for (int i = 0; i < plan->series_count; i++)
        if (strcmp(plan->series[i].name, name) == 0)
            return true;
    return false;
}

/* Presets, plans and series that steps name exist. */
static void test_names_in_steps_exist(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_plan plan;
    int presets = 0, series = 0;
    make_plan(&arena, "full", NULL, &plan);
    for (int i = 0; i < plan.count; i++) {
        const char *file = "sweep", *const *words = plan.steps[i].words;
        struct neph_sweep_plan sweep;
        struct neph_settings settings;
        const struct neph_engine *engine;
        for (int w = 1; words[w]; w++) {
            file = strcmp(words[w - 1], "--plan") == 0 ? words[w] : file;
            if (strcmp(words[w - 1], "--preset") == 0 && ++presets)
                neph_assert_ok(
                    neph_engine_parse_words(words[w], "steps=8", &engine, &settings, NULL), NULL);
        }
        if (plan.steps[i].suite != NEPH_NIGHT_SWEEP)
            continue;
        neph_assert_ok(neph_sweep_plan_load(file, &sweep, NULL), NULL);
        for (int w = 1; words[w]; w++) {
            if (strcmp(words[w - 1], "--only") != 0)
                continue;
            char *only = strdup(words[w]), *rest = only;
            for (const char *name; (name = strsep(&rest, ",")); series++)
                if (!has_series(&sweep, name))
                    fail_msg("%s: the plan %s has no series %s", plan.steps[i].name, file, name);
            free(only);
        }
        neph_sweep_plan_finish(&sweep);
    }
    assert_true(presets >= 11 && series >= 10);
    neph_arena_finish(&arena);
}

/* One scene each for froxels, point lights, cloud shadow maps, sheets, fog models and the sky. */
static void test_the_quick_tier_covers_the_air(void **state)
{
    static const char *const wanted[] = {"failure froxel_leak",       "sweep spot_fence",
                                         "sweep cloud_gaps",          "sweep cirrus",
                                         "catalog fog_look_physical", "catalog sky_earth"};
    struct neph_arena arena = {NULL};
    struct neph_night_plan plan;
    make_plan(&arena, "quick", NULL, &plan);
    for (size_t k = 0; k < COUNT(wanted); k++) {
        int found = 0;
        for (int i = 0; i < plan.count; i++)
            found += strcmp(plan.steps[i].name, wanted[k]) == 0;
        assert_int_equal(found, 1);
    }
    neph_arena_finish(&arena);
}

/* Steps and series keep the word "failure" that the stress tests had first. */
static void test_the_stress_tests_keep_their_word_in_names(void **state)
{
    static const struct {
        const char *step, *text;
        bool is_named;
    } cases[] = {
        {"failure ridge_far", "stress ridge_far", true},
        {"failure ridge_far", "stress", true},
        {"failure ridge_far", "failure ridge", true},
        {"failure ridge_far", "stress fog", false},
        {"failure ridge_far", "ridge", true},
        {"sweep ridge_far", "stress", false},
        {"catalog stress_one", "stress_one", true},
        {"catalog stress_one", "stress", false},
    };
    assert_string_equal(neph_night_suite_name(NEPH_NIGHT_STRESS), "failure");
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_true(neph_night_is_named(cases[i].step, cases[i].text) == cases[i].is_named);
}

/* `neph benchmark` refuses a scene that one of its engines cannot render. */
static void test_timed_scenes_can_be_rendered(void **state)
{
    static const char *const timed[] = {"march", "realtime"};
    struct neph_arena arena = {NULL};
    struct neph_night_plan plan;
    char reason[512];
    int count = 0;
    make_plan(&arena, "full", NULL, &plan);
    for (int i = 0; i < plan.count; i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {0};
        if (plan.steps[i].suite != NEPH_NIGHT_SPEED)
            continue;
        neph_assert_ok(neph_data_load_scene(plan.steps[i].words[1], &scene, &diag), &diag);
        for (size_t e = 0; e < COUNT(timed); e++, count++) {
            const struct neph_engine *engine = neph_engine_find(timed[e]);
            const struct neph_settings settings = neph_settings_default(engine);
            assert_true(engine->can_render(scene, &settings, reason, sizeof(reason)));
        }
        neph_scene_destroy(scene);
    }
    assert_true(count >= 6);
    neph_arena_finish(&arena);
}

/* Requested engines and seeds apply to the catalogue only. */
static void test_requests_apply_to_the_catalogue(void **state)
{
    const char *const engines[] = {"command"};
    const struct neph_night_plan_params params = {
        .tier = "quick", .engines = engines, .engine_count = 1, .seed = 3};
    struct neph_arena arena = {NULL};
    struct neph_night_plan plan;
    neph_assert_ok(neph_night_plan_make(&params, &arena, &plan, NULL), NULL);
    for (int i = 0; i < plan.count; i++) {
        bool has_engine = false, has_seed = false;
        for (int w = 1; plan.steps[i].words[w]; w++) {
            const char *before = plan.steps[i].words[w - 1], *word = plan.steps[i].words[w];
            has_engine |= strcmp(before, "-e") == 0 && strcmp(word, "command") == 0;
            has_seed |= strcmp(before, "--seed") == 0 && strcmp(word, "3") == 0;
        }
        assert_int_equal(has_engine, plan.steps[i].suite == NEPH_NIGHT_CATALOG);
        assert_int_equal(has_seed, plan.steps[i].suite == NEPH_NIGHT_CATALOG);
    }
    neph_arena_finish(&arena);
}

static void test_different_plans_have_different_keys(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_plan all, some, none;
    make_plan(&arena, "quick", NULL, &all);
    make_plan(&arena, "quick", "voxel_grid", &some);
    assert_string_not_equal(all.identity, some.identity);
    assert_int_equal(some.count, 3); /* the scene, its sweep, its speed */
    const char *const nothing = "nothing";
    const struct neph_night_plan_params without = {
        .tier = "quick", .only = &nothing, .only_count = 1};
    assert_int_equal(neph_night_plan_make(&without, &arena, &none, NULL), NEPH_ERR_USAGE);
    const char *const settings[] = {"a:b=1",  "a:b=2",  "a:b=3",  "a:b=4",  "a:b=5",  "a:b=6",
                                    "a:b=7",  "a:b=8",  "a:b=9",  "a:b=10", "a:b=11", "a:b=12",
                                    "a:b=13", "a:b=14", "a:b=15", "a:b=16"};
    const struct neph_night_plan_params crowded = {
        .tier = "quick", .settings = settings, .setting_count = COUNT(settings)};
    assert_int_equal(neph_night_plan_make(&crowded, &arena, &none, NULL), NEPH_ERR_USAGE);
    const struct neph_night_plan_params tier = {.tier = "slow"};
    assert_int_equal(neph_night_plan_make(&tier, &arena, &none, NULL), NEPH_ERR_USAGE);
    neph_arena_finish(&arena);
}

static void test_most_series_per_second_come_first(void **state)
{
    struct neph_night_step steps[4] = {{.guess_s = 10, .guess_series = 10},
                                       {.guess_s = 10, .guess_series = 10},
                                       {.guess_s = 10, .guess_series = 10},
                                       {.guess_s = 10, .guess_series = 10}};
    const struct neph_night_plan plan = {steps, 4, ""};
    const struct neph_step_history history[4] = {
        {NAN, 0, 1}, /* as estimated: one per second */
        {5.0, 20, 1} /* four per second */,
        {2.0, 2, 9}, /* one per second, not run for nine nights */
        {100.0, 1000, 1} /* ten per second, and long */};
    bool done[4] = {false};
    assert_int_equal(neph_night_plan_next(&plan, history, done, 1000.0, false), 3);
    assert_int_equal(neph_night_plan_next(&plan, history, done, 60.0, false), 2);
    done[2] = true;
    assert_int_equal(neph_night_plan_next(&plan, history, done, 60.0, false), 1);
    done[1] = true;
    assert_int_equal(neph_night_plan_next(&plan, history, done, 60.0, false), 0);
    assert_int_equal(neph_night_plan_next(&plan, history, done, 9.0, false), -1);
    assert_int_equal(neph_night_plan_next(&plan, history, done, 9.0, true), 3);
}

/* ---- results --------------------------------------------------------------------------------- */

static double find_series_number(const struct neph_night_numbers *numbers, const char *series)
{
    for (int i = 0; i < numbers->count; i++)
        if (strcmp(numbers->list[i].series, series) == 0)
            return numbers->list[i].value;
    return NAN;
}

static void read_text(enum neph_night_suite suite, const char *text, double calibration_s,
                      struct neph_arena *arena, struct neph_night_numbers *numbers)
{
    struct neph_diag diag = {0};
    json_t *document = json_loads(text, 0, NULL);
    assert_non_null(document);
    neph_assert_ok(neph_night_read(suite, document, calibration_s, "host", arena, numbers, &diag),
                   &diag);
    json_decref(document);
}

/* Two pixels, the second of which is 3. */
static void write_frame_image(const char *path, float first)
{
    struct neph_image *image = grey_image(2, 1, 3.0);
    set_grey(image, 0, first);
    write_image(path, image);
}

static void test_results_of_the_catalogue(void **state)
{
    char path[SCRATCH_PATH_MAX], text[4096];
    struct neph_arena arena = {NULL};
    struct neph_night_numbers numbers;
    write_frame_image(scratch_path(state, path, "a.exr"), 1.0f);
    snprintf(text, sizeof(text),
             "{\"size_px\": [96, 54], \"engines\": ["
             "{\"name\": \"exact\", \"version\": \"2\", \"device\": \"CPU\"},"
             "{\"name\": \"tracer\", \"version\": \"V\", \"device\": \"D\"}],"
             "\"scenes\": [{\"name\": \"fog\", \"hash\": \"0123456789abcdef\","
             "\"truth\": {\"engine\": \"exact\"}, \"frames\": ["
             "{\"engine\": \"tracer\", \"status\": \"rendered\", \"note\": \"less\", \"exr\": "
             "\"%s\", \"measurements\": ["
             "{\"quantity\": \"radiance\", \"metric\": \"rel_rmse\", \"mask\": \"all\", \"value\": "
             "0.25, \"interval\": [0.2, 0.3]},"
             "{\"quantity\": \"radiance\", \"metric\": \"rel_rmse\", \"mask\": \"sky\", \"value\": "
             "9, \"interval\": null},"
             "{\"quantity\": \"transmittance\", \"metric\": \"max_abs\", \"mask\": \"all\", "
             "\"value\": null, \"interval\": null}]},"
             "{\"engine\": \"exact\", \"status\": \"failed\", \"measurements\": []}],"
             "\"gates\": [{\"verdict\": \"fail\"}, {\"verdict\": \"pass\"}]}]}",
             path);
    read_text(NEPH_NIGHT_CATALOG, text, NAN, &arena, &numbers);
    assert_int_equal(numbers.count, 3);
    assert_string_equal(numbers.size, "96x54");
    const char *series = "catalog/fog@01234567/tracer/radiance rel_rmse/exact";
    neph_assert_close(find_series_number(&numbers, series), 0.25, 0.0, 0.0);
    neph_assert_close(find_series_number(&numbers, "catalog/fog@01234567/tracer/contrast"), 1.0,
                      1e-6, 0.0);
    neph_assert_close(find_series_number(&numbers, "catalog/fog@01234567/all/gates failed"), 1.0,
                      0.0, 0.0);
    for (int i = 0; i < numbers.count; i++) {
        if (strcmp(numbers.list[i].series, series) != 0)
            continue;
        assert_string_equal(numbers.list[i].kind, "drawn");
        assert_string_equal(numbers.list[i].environment, "V, D; less; against 2, CPU");
        neph_assert_close(numbers.list[i].standard_error, 0.05 / 1.95996398454, 1e-9, 0.0);
    }
    write_frame_image(path, NAN);
    read_text(NEPH_NIGHT_CATALOG, text, NAN, &arena, &numbers);
    neph_assert_close(find_series_number(&numbers, "catalog/fog@01234567/tracer/contrast"),
                      NEPH_NIGHT_BROKEN_PICTURE, 0.0, 0.0);
    neph_arena_finish(&arena);
}

static void test_results_of_the_other_suites(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_numbers numbers;
    read_text(NEPH_NIGHT_PHYSICS,
              "{\"physics\": {\"rows\": [{\"check\": \"slab\", \"participant\": \"march\", "
              "\"engine\": \"march\", \"deviation\": -0.01, \"standard_error\": null}]}}",
              NAN, &arena, &numbers);
    neph_assert_close(find_series_number(&numbers, "physics/slab/march/deviation/theory"), -0.01,
                      0.0, 0.0);
    read_text(NEPH_NIGHT_STRESS,
              "{\"device\": \"D\", \"results\": [{\"scene\": \"none\", \"point\": \"\", "
              "\"measure\": \"error\", \"over\": \"solid\", \"column\": \"ours\", \"value\": 0.5}, "
              "{\"scene\": \"none\", \"point\": \"\", \"measure\": \"lag\", \"over\": \"all\", "
              "\"column\": \"ours\", \"value\": null}]}",
              NAN, &arena, &numbers);
    assert_int_equal(numbers.count, 1);
    neph_assert_close(find_series_number(&numbers, "failure/none/ours/error over solid"), 0.5, 0.0,
                      0.0);
    static const char speed[] =
        "{\"scene\": \"fog\", \"scene_hash\": \"0123456789\", \"size_px\": [8, 6], \"engines\": "
        "[{\"engine\": \"march\", \"version\": \"V\", \"device\": \"llvmpipe\", \"frame_s\": "
        "{\"median\": "
        "0.02}, \"passes\": [{\"density_evaluations\": 30.0}, {\"density_evaluations\": 12.0}]}]}";
    read_text(NEPH_NIGHT_SPEED, speed, 0.1, &arena, &numbers);
    neph_assert_close(find_series_number(&numbers, "speed/fog@01234567/march/time"), 0.2, 1e-12,
                      0.0);
    neph_assert_close(find_series_number(&numbers, "speed/fog@01234567/march/evaluations"), 42.0,
                      0.0, 0.0);
    read_text(NEPH_NIGHT_SPEED, speed, NAN, &arena, &numbers); /* on a busy machine */
    assert_int_equal(numbers.count, 1);
    read_text(
        NEPH_NIGHT_SPEED, /* a device of its own is its own environment */
        "{\"scene\": \"fog\", \"scene_hash\": \"0123456789\", \"size_px\": [8, 6], "
        "\"ceilings\": {\"buffer_samples_per_s\": 1e9}, \"engines\": [{\"engine\": \"march\", "
        "\"version\": \"V\", \"device\": \"card\", \"frame_s\": {\"median\": 0.002}}]}",
        0.1, &arena, &numbers);
    neph_assert_close(find_series_number(&numbers, "speed/fog@01234567/march/time"), 2000.0, 1e-9,
                      0.0);
    json_t *other = json_pack("{s:i}", "scenes", 1);
    assert_int_equal(neph_night_read(NEPH_NIGHT_CATALOG, other, NAN, "", &arena, &numbers, NULL),
                     NEPH_ERR_ENGINE);
    json_decref(other);
    neph_arena_finish(&arena);
}

static void test_results_between_warnings(void **state)
{
    json_t *found = neph_night_find_document("neph: {what}\n{\n \"a\": 1\n}\nneph: and after\n");
    assert_int_equal(json_integer_value(json_object_get(found, "a")), 1);
    json_decref(found);
    assert_null(neph_night_find_document("neph: nothing\n"));
}

/* ---- histories ------------------------------------------------------------------------------- */

/* Runs in a store of the test: the state of each test below. */
struct bench {
    struct scratch scratch;
    struct neph_store *store;
    struct neph_database *index;
    struct neph_night_comparison c; /* the latest */
};

static int open_bench(void **state)
{
    struct bench *bench = calloc(1, sizeof(*bench));
    if (!bench || scratch_setup(state))
        return -1;
    bench->scratch = *(struct scratch *)*state;
    free(*state);
    *state = bench;
    bench->store = open_store(state);
    return neph_store_index(bench->store, &bench->index, NULL);
}

static int close_bench(void **state)
{
    struct bench *bench = *state;
    neph_night_comparison_finish(&bench->c);
    neph_database_close(bench->index);
    neph_store_close(bench->store);
    return scratch_teardown(state);
}

#define bench_test(function) cmocka_unit_test_setup_teardown(function, open_bench, close_bench)

/* Adds a run of one step, finished or not. */
static int64_t add_night(struct bench *bench, const struct neph_history_step *step,
                         const struct neph_measurement *numbers, int count, bool is_over)
{
    const struct neph_history_night who = {"quick", "a", "program", "host"};
    struct neph_diag diag = {0};
    int64_t night = 0;
    bool resumed;
    json_t *none = json_array();
    neph_assert_ok(neph_history_begin(bench->index, neph_store_folder(bench->store), &who, &night,
                                      &resumed, &diag),
                   &diag);
    neph_assert_ok(neph_history_add(bench->index, night, step, numbers, count, &diag), &diag);
    if (is_over)
        neph_assert_ok(neph_history_end(bench->index, neph_store_folder(bench->store), night,
                                        "pass", none, &diag),
                       &diag);
    json_decref(none);
    return night;
}

static void accept(struct bench *bench, const char *series, int64_t night)
{
    neph_assert_ok(neph_history_accept(bench->index, neph_store_folder(bench->store), series, night,
                                       "me", "looked at", NULL),
                   NULL);
}

static const struct neph_history_step fog_step = {"catalog fog", "done", "", "96x54", 1.0, NAN};

#define FOG(hash, end) "catalog/fog@" hash "/march/" end

static const struct neph_measurement fog = {
    FOG("1", "radiance rel_rmse/exact"), "fixed", 0.25, NAN, "D", ""};

static int count_found(const struct neph_night_comparison *c, enum neph_found found)
{
    int count = 0;
    for (int i = 0; i < c->finding_count; i++)
        count += c->findings[i].found == found;
    return count;
}

static void compare_within(struct bench *bench, int64_t night, int64_t against,
                           const struct neph_night_scope *scope)
{
    struct neph_diag diag = {0};
    neph_night_comparison_finish(&bench->c);
    neph_assert_ok(neph_night_compare(bench->index, night, against, scope, alpha, &bench->c, &diag),
                   &diag);
}

static void compare(struct bench *bench, int64_t night, int64_t against)
{
    compare_within(bench, night, against, NULL);
}

/* Compares a run with only this value of the fog. */
static void compare_fog_value(struct bench *bench, const struct neph_measurement *number)
{
    compare(bench, add_night(bench, &fog_step, number, 1, true), 0);
}

static void test_a_run_without_a_baseline(void **state)
{
    struct bench *bench = *state;
    const int64_t first = add_night(bench, &fog_step, &fog, 1, true);
    const int64_t night = add_night(bench, &fog_step, &fog, 1, false);
    compare(bench, night, 0);
    assert_int_equal(bench->c.compared, 0);
    assert_int_equal(bench->c.fresh, 1);
    assert_false(bench->c.passes);
    compare(bench, night, first); /* unless one is named */
    assert_int_equal(bench->c.compared, 1);
    assert_true(bench->c.passes);
    assert_int_equal(neph_night_compare(bench->index, night, 99, NULL, alpha, &bench->c, NULL),
                     NEPH_ERR_NOT_FOUND);
}

/* One finding of each kind. */
static void test_findings_of_a_run(void **state)
{
    const struct neph_measurement before[] = {
        {FOG("1", "radiance rel_rmse/exact"), "fixed", 0.25, NAN, "D", ""},
        {FOG("1", "radiance rel_bias/exact"), "fixed", -0.1, NAN, "D", ""},
        {FOG("1", "radiance p99/exact"), "fixed", 0.5, NAN, "D", ""},
        {FOG("1", "transmittance max_abs/exact"), "fixed", 0.01, NAN, "D", ""},
        {FOG("1", "contrast"), "picture", 3.0, NAN, "D", ""},
        {"catalog/fog@1/cycles/contrast", "picture", 0.0, NAN, "B", ""},
        {"catalog/fog@1/cycles/radiance p99/exact", "drawn", 0.5, 0.1, "Blender 3.4", ""},
        {"catalog/sea@1/march/radiance p99/exact", "fixed", 0.5, NAN, "D", ""}};
    const struct neph_measurement tonight[] = {
        {FOG("1", "radiance rel_rmse/exact"), "fixed", 0.26, NAN, "D", ""},
        {FOG("1", "radiance rel_bias/exact"), "fixed", 0.05, NAN, "D", ""},
        {FOG("1", "radiance p99/exact"), "fixed", 0.5001, NAN, "D", ""},
        {FOG("1", "contrast"), "picture", 0.0, NAN, "D", ""},
        {"catalog/fog@1/cycles/contrast", "picture", 0.0, NAN, "B", ""},
        {"catalog/fog@1/cycles/radiance p99/exact", "drawn", 0.9, 0.1, "Blender 3.6", ""},
        {"catalog/sea@2/march/radiance p99/exact", "fixed", 0.7, NAN, "D", ""}};
    static const struct {
        enum neph_found found;
        const char *series; /* its end */
    } expected[] = {
        {NEPH_FOUND_BLANK, "march/contrast"},  {NEPH_FOUND_MISSING, "max_abs/exact"},
        {NEPH_FOUND_WORSE, "rel_rmse/exact"},  {NEPH_FOUND_EDITED, "sea@1"},
        {NEPH_FOUND_BETTER, "rel_bias/exact"}, {NEPH_FOUND_ENVIRONMENT, "Blender 3.6"},
        {NEPH_FOUND_MOVED, "p99/exact"},
    };
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, before, COUNT(before), true));
    compare(bench, add_night(bench, &fog_step, tonight, COUNT(tonight), false), 0);
    assert_int_equal(bench->c.finding_count, COUNT(expected));
    for (int i = 0; i < bench->c.finding_count; i++) {
        const char *series = bench->c.findings[i].series, *end = expected[i].series;
        assert_int_equal(bench->c.findings[i].found, expected[i].found);
        assert_string_equal(series + strlen(series) - strlen(end), end);
    }
    assert_int_equal(bench->c.compared, 3);
    assert_int_equal(bench->c.fresh, 1); /* the changed scene */
    assert_int_equal(bench->c.elsewhere, 1);
    assert_false(bench->c.passes);
}

static void test_another_size_and_a_broken_step(void **state)
{
    struct neph_history_step step = fog_step;
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, &fog, 1, true));
    step.size = "48x27";
    compare(bench, add_night(bench, &step, &fog, 1, true), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_SIZE), 1);
    assert_int_equal(bench->c.compared, 0);
    assert_false(bench->c.passes);
    step.outcome = "failed";
    step.reason = "a crash";
    compare(bench, add_night(bench, &step, NULL, 0, false), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_STEP), 1);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_MISSING), 0); /* reported once */
    assert_false(bench->c.passes);
}

/* Durations of a step without calibration are not missing; its other missing values are. */
static void test_a_busy_machine_fails_no_run(void **state)
{
    const struct neph_measurement numbers[] = {
        {"speed/fog@1/march/evaluations", "fixed", 42.0, NAN, "D", ""},
        {"speed/fog@1/march/time", "timed", 1.0, NAN, "D; on host", ""}};
    const struct {
        int first, count; /* of the run's values */
        double calibration_s;
        int missing;
    } cases[] = {{0, 2, 0.1, 0}, {0, 1, NAN, 0}, {0, 1, 0.1, 1}, {1, 1, 0.1, 1}, {0, 0, NAN, 1}};
    struct neph_history_step step = {"speed fog", "done", "", "192x108", 1.0, 0.1};
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &step, numbers, 2, true));
    for (size_t i = 0; i < COUNT(cases); i++) {
        step.calibration_s = cases[i].calibration_s;
        compare(bench, add_night(bench, &step, numbers + cases[i].first, cases[i].count, true), 0);
        assert_int_equal(count_found(&bench->c, NEPH_FOUND_MISSING), cases[i].missing);
        if (i < 2)
            assert_true(bench->c.passes);
    }
}

/* An intended change: an alarm for its series until it is accepted; then a change back is an alarm.
 */
static void test_acceptances_of_a_series(void **state)
{
    const char *const a = FOG("1", "radiance rel_rmse/exact"), *const b = FOG("1", "radiance "
                                                                                   "p99/exact");
    const struct neph_measurement old[] = {{a, "fixed", 0.25, NAN, "D", ""},
                                           {b, "fixed", 0.5, NAN, "D", ""}},
                                  new[] = {{a, "fixed", 0.30, NAN, "D", ""},
                                           {b, "fixed", 0.6, NAN, "D", ""}};
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, old, 2, true));
    const int64_t changed = add_night(bench, &fog_step, new, 2, true);
    accept(bench, a, changed);
    compare(bench, add_night(bench, &fog_step, new, 2, true), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
    assert_string_equal(bench->c.findings[0].series, b);
    accept(bench, "*", changed);
    compare(bench, add_night(bench, &fog_step, new, 2, true), 0);
    assert_true(bench->c.passes && bench->c.finding_count == 0);
    compare(bench, add_night(bench, &fog_step, old, 2, true), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_BETTER), 2);
}

/* A value that was accepted by itself is missed until a run without it is accepted. */
static void test_a_value_accepted_alone_is_missed(void **state)
{
    const char *const a = FOG("1", "radiance rel_rmse/exact"), *const b = FOG("1", "radiance "
                                                                                   "p99/exact");
    const struct neph_measurement numbers[] = {{a, "fixed", 0.25, NAN, "D", ""},
                                               {b, "fixed", 0.5, NAN, "D", ""}};
    struct bench *bench = *state;
    const int64_t first = add_night(bench, &fog_step, numbers, 1, true);
    accept(bench, "*", first);
    accept(bench, b, add_night(bench, &fog_step, numbers, 2, true));
    const int64_t without = add_night(bench, &fog_step, numbers, 1, true);
    compare(bench, without, 0);
    assert_int_equal(bench->c.finding_count, 1);
    assert_int_equal(bench->c.findings[0].found, NEPH_FOUND_MISSING);
    assert_string_equal(bench->c.findings[0].series, b);
    compare(bench, without, first);
    assert_int_equal(bench->c.finding_count, 0);
    accept(bench, "*", without);
    compare(bench, add_night(bench, &fog_step, numbers, 1, true), 0);
    assert_int_equal(bench->c.finding_count, 0);
}

/* --- values that are not compared ------------------------------------------------------------- */

#define SEA "catalog/sea@1/march/radiance rel_rmse/exact"

static const struct neph_history_step sea_step = {"catalog sea", "done", "", "96x54", 1.0, NAN};

/* A first run of fog and sea, accepted. */
static void accept_two_steps(struct bench *bench)
{
    const struct neph_measurement sea = {SEA, "fixed", 0.25, NAN, "D", ""};
    const int64_t first = add_night(bench, &fog_step, &fog, 1, false);
    add_night(bench, &sea_step, &sea, 1, true);
    accept(bench, "*", first);
}

/* Compares a run of the fog only, with these steps in its plan. */
static void compare_fog(struct bench *bench, const char *const *planned, int planned_count)
{
    const struct neph_night_scope scope = {.planned = planned, .planned_count = planned_count};
    compare_within(bench, add_night(bench, &fog_step, &fog, 1, false), 0, &scope);
}

/* A planned step without time is no alarm for thirty runs; a step that left the plan is one, until
 * it is accepted. */
static void test_a_step_that_was_not_run_and_one_that_is_gone(void **state)
{
    static const char *const planned[] = {"catalog fog", "catalog sea"};
    struct bench *bench = *state;
    accept_two_steps(bench);
    compare_fog(bench, planned, 1);
    assert_int_equal(bench->c.finding_count, 1);
    assert_int_equal(bench->c.findings[0].found, NEPH_FOUND_LOST);
    assert_string_equal(bench->c.findings[0].series, SEA);
    assert_true(!bench->c.passes && bench->c.not_run == 0);
    for (int nights = 1; nights <= neph_lost_after_nights + 1; nights++) {
        compare_fog(bench, planned, 2);
        const bool overdue = nights > neph_lost_after_nights;
        assert_int_equal(count_found(&bench->c, NEPH_FOUND_LOST), overdue);
        assert_true(bench->c.passes != overdue && bench->c.not_run == 1);
        add_night(bench, &fog_step, &fog, 1, true);
    }
    accept(bench, SEA, 5); /* it has not measured the series */
    compare_fog(bench, planned, 1);
    assert_true(bench->c.passes && bench->c.finding_count == 0);
}

/* An accepted run without time for the sea: the sea is still compared with the first run. */
static void test_untimed_steps_stay_expected(void **state)
{
    static const char *const planned[] = {"catalog fog", "catalog sea"};
    const struct neph_measurement sea = {SEA, "fixed", 0.26, NAN, "D", ""};
    const struct neph_history_step left_out = {"catalog sea", "not run", "", "", 0.0, NAN};
    struct bench *bench = *state;
    accept_two_steps(bench);
    const int64_t short_of_time = add_night(bench, &fog_step, &fog, 1, false);
    add_night(bench, &left_out, NULL, 0, true);
    accept(bench, "*", short_of_time);
    compare_fog(bench, planned, 1);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_LOST), 1);
    add_night(bench, &fog_step, &fog, 1, true);
    compare(bench, add_night(bench, &sea_step, &sea, 1, true), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
    assert_int_equal(bench->c.fresh, 0);
}

/* Compares a value with one accepted in another environment. */
static void judge_elsewhere(struct bench *bench, const struct neph_measurement *before,
                            const struct neph_measurement *tonight, enum neph_found found,
                            bool passes)
{
    const struct neph_measurement steady = {
        FOG("1", "radiance p99/exact"), "fixed", 0.25, NAN, "D", ""};
    const struct neph_measurement first[] = {*before, steady}, second[] = {*tonight, steady};
    accept(bench, "*", add_night(bench, &fog_step, first, 2, true));
    compare(bench, add_night(bench, &fog_step, second, 2, true), 0);
    assert_int_equal(bench->c.passes, passes);
    assert_int_equal(bench->c.findings[0].found, found);
}

/* A raised version does not hide a regression of the same run, and is no alarm by itself.
 * Durations, and frames with fewer samples, are not comparable. */
static void test_numbers_of_another_environment(void **state)
{
    static const struct {
        const char *metric, *kind;
        double before, tonight, error;
        const char *accepted_in, *measured_in;
        enum neph_found found;
        bool passes;
    } cases[] = {
        {"radiance rel_rmse/exact", "fixed", 0.25, 0.26, NAN, "V 1", "V 2",
         NEPH_FOUND_WORSE_ELSEWHERE, false},
        {"radiance rel_rmse/exact", "fixed", 0.25, 0.2501, NAN, "V 1", "V 2",
         NEPH_FOUND_ENVIRONMENT, true},
        {"radiance rel_rmse/exact", "fixed", 0.25, 0.2, NAN, "V 1", "V 2", NEPH_FOUND_ENVIRONMENT,
         true},
        {"radiance rel_bias/exact", "fixed", -0.1, -0.2, NAN, "V 1", "V 2",
         NEPH_FOUND_WORSE_ELSEWHERE, false},
        {"radiance rel_rmse/exact", "drawn", 0.25, 0.35, 0.01, "V 1", "V 2",
         NEPH_FOUND_WORSE_ELSEWHERE, false},
        {"radiance rel_rmse/exact", "drawn", 0.25, 0.26, 0.01, "V 1", "V 2", NEPH_FOUND_ENVIRONMENT,
         true},
        {"radiance rel_rmse/exact", "drawn", 0.25, 0.35, 0.01, "V; against W",
         "V; 8 samples; "
         "against W",
         NEPH_FOUND_ENVIRONMENT, true},
        {"radiance rel_rmse/exact", "fixed", 0.25, 0.35, NAN, "V; against W",
         "V; a look; against W", NEPH_FOUND_WORSE_ELSEWHERE, false},
        {"time", "timed", 1.0, 9.0, NAN, "V; on A", "V; on B", NEPH_FOUND_ENVIRONMENT, true},
        {"radiance rel_rmse/exact", "fixed", 0.25, 0.2501, NAN, "V, revision 9, CPU; against W",
         "V, revision 10, CPU; against W", NEPH_FOUND_MOVED, true},
        {"contrast", "picture", 3.0, 0.0, NAN, "V 1", "V 2", NEPH_FOUND_BLANK, false},
    };
    struct bench *bench = *state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        char name[128];
        snprintf(name, sizeof(name), "catalog/fog@1/march/%s", cases[i].metric);
        const struct neph_measurement
            before = {name,           cases[i].kind,        cases[i].before,
                      cases[i].error, cases[i].accepted_in, ""},
            tonight = {name,           cases[i].kind,        cases[i].tonight,
                       cases[i].error, cases[i].measured_in, ""};
        judge_elsewhere(bench, &before, &tonight, cases[i].found, cases[i].passes);
    }
}

/* Each environment has its own baseline: the last accepted run that measured in it. */
static void test_each_environment_has_its_baseline(void **state)
{
    struct bench *bench = *state;
    struct neph_measurement here = fog, there = fog;
    here.environment = "V, revision 1, GPU", there.environment = "V, revision 1, CPU";
    here.value = 0.2, there.value = 0.3;
    accept(bench, "*", add_night(bench, &fog_step, &here, 1, true));
    accept(bench, "*", add_night(bench, &fog_step, &there, 1, true));
    here.environment = "V, revision 2, GPU";
    compare_fog_value(bench, &here);
    assert_true(bench->c.passes);
    assert_int_equal(bench->c.compared, 1);
    assert_int_equal(bench->c.elsewhere, 0);
    here.value = 0.25; /* better than the CPU's, which was accepted last */
    compare_fog_value(bench, &here);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
    assert_int_equal(bench->c.findings[0].accepted, 1);
    here.environment = "V, another GPU"; /* of which no run was accepted */
    compare_fog_value(bench, &here);
    assert_int_equal(bench->c.elsewhere, 1);
    assert_non_null(strstr(bench->c.series[0].why, "no run of it is accepted"));
    accept(bench, fog.series, add_night(bench, &fog_step, &here, 1, true));
    compare_fog_value(bench, &here);
    assert_int_equal(bench->c.compared, 1);
    assert_true(bench->c.passes);
    /* Accepted as lost: what an environment had before does not count. */
    const struct neph_measurement other = {
        FOG("1", "radiance p99/exact"), "fixed", 0.25, NAN, "D", ""};
    accept(bench, fog.series, add_night(bench, &fog_step, &other, 1, true));
    compare_fog_value(bench, &here);
    assert_int_equal(bench->c.compared, 0);
    assert_int_equal(bench->c.fresh, 1);
}

/* An engine that is declared stochastic from this run on does not get eight runs without judgement.
 */
static void test_a_fixed_number_that_is_called_drawn_is_judged_as_before(void **state)
{
    struct neph_measurement number = fog;
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, &number, 1, true));
    number.kind = "drawn";
    number.value = 0.26;
    compare(bench, add_night(bench, &fog_step, &number, 1, false), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
}

/* Small changes in every run: each is compared with the accepted run. */
static void test_slow_drift_is_found(void **state)
{
    struct neph_measurement number = fog;
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, &number, 1, true));
    for (int i = 1; i <= 2; i++) {
        number.value = 0.25 * (1.0 + 0.004 * i);
        compare_fog_value(bench, &number);
        assert_int_equal(bench->c.findings[0].found, i == 1 ? NEPH_FOUND_MOVED : NEPH_FOUND_WORSE);
    }
}

/* Runs are ordered by number, whatever the clock says. */
static void test_a_clock_that_was_set_back_changes_no_verdict(void **state)
{
    const struct neph_history_night who = {"quick", "a", "program", "host"};
    struct neph_measurement number = fog;
    struct bench *bench = *state;
    accept(bench, "*", add_night(bench, &fog_step, &number, 1, true));
    number.value = 0.26;
    neph_assert_ok(neph_history_adopt(bench->index, neph_store_folder(bench->store), &who, 2,
                                      "1970-01-01T00:00:00Z", NULL),
                   NULL);
    neph_assert_ok(neph_history_add(bench->index, 2, &fog_step, &number, 1, NULL), NULL);
    compare(bench, 2, 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
}

/* Runs in which a series was worse are not used for later comparisons. */
static void test_worse_runs_are_excluded(void **state)
{
    struct bench *bench = *state;
    struct neph_measurement number = {
        "speed/fog@1/march/time", "timed", 1.0, NAN, "D; on host", ""};
    for (int i = 0; i < 30; i++) {
        const bool is_slow = i >= 10;
        number.value = (is_slow ? 2.0 : 1.0) + 0.01 * (i % 3);
        const int64_t night = add_night(bench, &fog_step, &number, 1, false);
        if (is_slow)
            neph_assert_ok(neph_history_judge(bench->index, night, number.series, "worse", NULL),
                           NULL);
        add_night(bench, &fog_step, &number, 0, true); /* resumes the run and finishes it */
        if (i == 0)
            accept(bench, "*", night);
    }
    compare(bench, add_night(bench, &fog_step, &number, 1, false), 0);
    assert_int_equal(count_found(&bench->c, NEPH_FOUND_WORSE), 1);
    neph_assert_close(bench->c.findings[0].change, 1.0, 0.03, 0.0);
}

#define bench_test(function) cmocka_unit_test_setup_teardown(function, open_bench, close_bench)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_full_tier_goes_on_with_the_series_of_the_quick_one),
        cmocka_unit_test(test_timed_scenes_can_be_rendered),
        cmocka_unit_test(test_requests_apply_to_the_catalogue),
        cmocka_unit_test(test_names_in_steps_exist),
        cmocka_unit_test(test_the_quick_tier_covers_the_air),
        cmocka_unit_test(test_the_stress_tests_keep_their_word_in_names),
        cmocka_unit_test(test_different_plans_have_different_keys),
        cmocka_unit_test(test_most_series_per_second_come_first),
        scratch_test(test_results_of_the_catalogue),
        cmocka_unit_test(test_results_of_the_other_suites),
        cmocka_unit_test(test_results_between_warnings),
        bench_test(test_a_run_without_a_baseline),
        bench_test(test_findings_of_a_run),
        bench_test(test_another_size_and_a_broken_step),
        bench_test(test_a_busy_machine_fails_no_run),
        bench_test(test_acceptances_of_a_series),
        bench_test(test_a_value_accepted_alone_is_missed),
        bench_test(test_worse_runs_are_excluded),
        bench_test(test_a_step_that_was_not_run_and_one_that_is_gone),
        bench_test(test_untimed_steps_stay_expected),
        bench_test(test_numbers_of_another_environment),
        bench_test(test_each_environment_has_its_baseline),
        bench_test(test_a_fixed_number_that_is_called_drawn_is_judged_as_before),
        bench_test(test_slow_drift_is_found),
        bench_test(test_a_clock_that_was_set_back_changes_no_verdict),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: MIT
 *
 * Flicker studies without a renderer: the tables refer to existing metrics, suites are disjoint,
 * and pairs and rankings are computed correctly from synthetic values.
 */
#include "tests/harness/published.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/experiments/flicker.h"
#include "harness/study/flicker_pairs.h"
#include "harness/study/reference.h"
#include "harness/study/suites.h"
#include "metrics/extractors/extractors.h"
#include "metrics/significance.h"

/* ---- tables ---------------------------------------------------------------------------------- */

static bool is_listed(const char *const *names, const char *name)
{
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}

static void test_metrics_are_of_the_extractors_of_their_takes(void **state)
{
    assert_true(neph_study_metric_count() > 0);
    for (int m = 0; neph_study_metrics[m].title; m++) {
        const struct neph_study_metric *metric = &neph_study_metrics[m];
        const struct neph_study_capture *take = &neph_study_captures[metric->take];
        const char *const names[] = {metric->metric, metric->alone, metric->never_share,
                                     metric->at_most};
        for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
            const struct neph_extractor *owner = NULL;
            if (!names[i])
                continue;
            if (!neph_metric_find(names[i], &owner))
                fail_msg("there is no metric %s", names[i]);
            assert_true(is_listed(take->extractors, owner->name));
            if (metric->of_the_eye && i == 0)
                assert_true(is_listed(neph_study_eye_extractors, owner->name));
        }
        assert_true(!metric->of_the_eye || metric->take == NEPH_STUDY_FLICKER);
        assert_true(metric->least > 0.0 && metric->scale > 0.0);
    }
    assert_true(neph_study_metrics[neph_study_find_headline()].of_the_eye);
    assert_int_equal(neph_study_metrics[neph_study_find_lag()].take, NEPH_STUDY_STEP);
}

/* Settings of extractors are texts; they must contain the numbers that the variants use. */
static void test_settings_match_the_variants(void **state)
{
    char words[64];
    snprintf(words, sizeof(words), "lag.step_frame=%d", NEPH_STUDY_EVENT_FRAME);
    assert_true(is_listed(neph_study_captures[NEPH_STUDY_STEP].settings, words));
    assert_true(is_listed(neph_study_captures[NEPH_STUDY_CUT].settings, words));
    for (int i = 0; i < NEPH_VARIANT_PERIOD_COUNT; i++) {
        snprintf(words, sizeof(words), "follow.period_%d=%d", i + 1, neph_variant_periods[i]);
        assert_true(is_listed(neph_study_captures[NEPH_STUDY_SINE].settings, words));
        assert_int_equal(neph_study_captures[NEPH_STUDY_SINE].frame_count % neph_variant_periods[i],
                         0);
    }
}

/* All displays of the table, in which the first is of 30 Hz; or two of the scenes' rate, so that no
 * motion is shown at another rate than it has. */
static void test_displays_have_the_rate_of_the_scenes(void **state)
{
    const struct neph_study_display first = neph_study_display_at(0.0, 0);
    assert_int_equal(neph_study_display_count(0.0), NEPH_STUDY_DISPLAYS);
    assert_true(first.frame_rate_hz == 30.0 && first.pixels_per_degree == 60.0);
    assert_int_equal(neph_study_display_count(60.0), 2);
    for (int i = 0; i < 2; i++) {
        const struct neph_study_display display = neph_study_display_at(60.0, i);
        assert_true(display.frame_rate_hz == 60.0);
        assert_true(display.pixels_per_degree == (i == 0 ? 60.0 : 30.0));
    }
}

/* 256 frames at 30 Hz last as long as 512 at 60 Hz; at 24 Hz 204 of 204.8 are whole cycles of
 * four. */
static void test_a_study_lasts_as_long_at_every_rate(void **state)
{
    static const struct {
        double rate_hz, study_hz;
        int frames;
    } cases[] = {{NAN, 0.0, 256}, {30.0, 30.0, 256}, {60.0, 60.0, 512}, {24.0, 24.0, 204}};
    static const char *const one[] = {"ours"};
    const struct neph_experiment_run run = {.quiet = true};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const struct neph_flicker_request request = {.frame_rate_hz = cases[i].rate_hz,
                                                     .frame_count = 256};
        const struct neph_flicker_study_params made = neph_flicker_params(&request, one, 1, &run);
        assert_true(made.frame_rate_hz == cases[i].study_hz);
        assert_int_equal(made.frame_count, cases[i].frames);
    }
}

/* The reference of a test shares its steps and sun, but not a cloud shadow map, whose error is
 * measured. */
static void test_a_reference_has_no_shadow_map(void **state)
{
    struct neph_engine_info info;
    struct neph_job test = {.engine = neph_engine_find("realtime")}, march;
    struct neph_scene *scene = NULL;
    neph_assert_ok(neph_data_load_scene("cloud_gaps", &scene, NULL), NULL);
    test.shot.scene = scene;
    neph_assert_ok(neph_settings_parse_words(test.engine, "fixed+cloud_shadow=map+sun=marched",
                                             "steps=8", &test.shot.settings, NULL),
                   NULL);
    neph_assert_ok(neph_reference_job(&test, NEPH_REFERENCE_AVERAGED, &info, &march, NULL), NULL);
    assert_string_equal(march.engine->name, "march");
    assert_true(neph_setting(march.engine, &march.shot.settings, "cloud_shadow") == 0.0);
    assert_true(neph_setting(march.engine, &march.shot.settings, "steps") == 8.0);
    assert_true(neph_setting(march.engine, &march.shot.settings, "sun") ==
                neph_setting(test.engine, &test.shot.settings, "sun"));
    neph_scene_destroy(scene);
}

/* ---- suites ---------------------------------------------------------------------------------- */

static void assert_renders(const struct neph_scene *scene, const char *name, const char *preset)
{
    char reason[512];
    const struct neph_engine *engine = neph_engine_find(name);
    struct neph_settings settings = neph_settings_default(engine);
    if (preset)
        neph_assert_ok(neph_settings_preset(engine, preset, &settings, NULL), NULL);
    neph_settings_adapt_to_scene(engine, scene, &settings);
    if (!neph_engine_can_render(engine, scene, &settings, reason, sizeof(reason)))
        fail_msg("%s, %s: %s", scene->name, preset ? preset : name, reason);
}

/* All presets, their reference, and engine `exact` if the description names it. */
static void assert_engines_of_the_study_render(const struct neph_scene *scene)
{
    const struct neph_preset *preset = neph_engine_find("realtime")->presets;
    assert_renders(scene, "march", NULL);
    if (strstr(scene->description, "engine `exact`"))
        assert_renders(scene, "exact", NULL);
    for (; preset->name; preset++)
        assert_renders(scene, "realtime", preset->name);
}

static void test_suites_hold_scenes_that_are_there(void **state)
{
    static const char *const suites[] = {"tuning", "test", "test2", "air", "motion", "motion_test"};
    for (size_t s = 0; s < sizeof(suites) / sizeof(suites[0]); s++) {
        struct neph_arena arena = {.last = NULL};
        const char *const *names;
        int count = 0;
        struct neph_diag diag = {.line = 0};
        neph_assert_ok(neph_flicker_suite_find(suites[s], true, &arena, &names, &count, &diag),
                       &diag);
        assert_true(count >= 8);
        for (int i = 0; i < count; i++) {
            struct neph_scene *scene = NULL;
            neph_assert_ok(neph_data_load_scene(names[i], &scene, &diag), &diag);
            assert_int_equal(scene->scattering, NEPH_SCATTERING_SINGLE);
            assert_engines_of_the_study_render(scene);
            neph_scene_destroy(scene);
        }
        neph_arena_finish(&arena);
    }
}

static void test_an_unknown_suite_is_refused_with_those_there_are(void **state)
{
    struct neph_arena arena = {.last = NULL};
    const char *const *names;
    int count = 0;
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_flicker_suite_find("best", true, &arena, &names, &count, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.hint, "tuning"));
    assert_non_null(strstr(diag.hint, "test"));
}

/* Only a caller that opens it gets its scenes. */
static void test_a_shut_suite_is_refused_with_its_reason(void **state)
{
    struct neph_arena arena = {.last = NULL};
    const char *const *names;
    int count = 0;
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_flicker_suite_find("motion_test", false, &arena, &names, &count, &diag),
                     NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "motion_test is shut: no preset is measured"));
    assert_non_null(strstr(diag.hint, "--open-shut-suite"));
    assert_int_equal(count, 0);
    neph_assert_ok(neph_flicker_suite_find("motion_test", true, &arena, &names, &count, NULL),
                   NULL);
    assert_true(count >= 16);
    neph_arena_finish(&arena);
}

static void test_a_scene_in_both_suites_is_refused(void **state)
{
    static const char twice[] = "{\"format\": \"neph-flicker-suites-1\", \"suites\": {"
                                "\"tuning\": [{\"scene\": \"fog\", \"reason\": \"a\"}],"
                                "\"test\": [{\"scene\": \"fog\", \"reason\": \"b\"}]}}";
    char folder[] = "/tmp/neph-suites-XXXXXX", path[128];
    struct neph_arena arena = {.last = NULL};
    const char *const *names;
    int count = 0;
    struct neph_diag diag = {.line = 0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof(path), "%s/scenes", folder);
    assert_int_equal(neph_dir_create(path, NULL), NEPH_OK);
    snprintf(path, sizeof(path), "%s/scenes/studies", folder);
    assert_int_equal(neph_dir_create(path, NULL), NEPH_OK);
    snprintf(path, sizeof(path), "%s/scenes/studies/flicker.json", folder);
    assert_int_equal(neph_file_write(path, twice, strlen(twice), NULL), NEPH_OK);
    setenv("NEPH_DATA_DIR", folder, 1);
    assert_int_equal(neph_flicker_suite_find("test", false, &arena, &names, &count, &diag),
                     NEPH_ERR_INPUT);
    unsetenv("NEPH_DATA_DIR");
    assert_non_null(strstr(diag.message, "fog"));
    neph_dir_remove(folder, NULL);
}

/* --- values of a study ------------------------------------------------------------------------ */

enum { SCENES = 4, PRESETS = 3, SEEDS = 2 };

static const char *const presets[PRESETS] = {"a", "b+\"x\"=1", "c<d"};
static const struct neph_flicker_study_params params = {
    .presets = presets,
    .preset_count = PRESETS,
    .scene_count = SCENES,
    .seed_count = SEEDS,
    .frame_count = 64,
    .steps = 8,
    .width_px = 16,
    .height_px = 9,
    .takes = {true, true, true, true},
};

/* Every cell counts and is 1; scenes have names. */
static void make_study(struct neph_flicker_study *study)
{
    static const char *const names[SCENES] = {"one", "two", "three", "four"};
    neph_assert_ok(neph_flicker_study_begin(&params, study, NULL), NULL);
    snprintf(study->device, sizeof(study->device), "nowhere");
    for (int s = 0; s < SCENES; s++)
        study->scenes[s] = (struct neph_study_scene){
            .name = names[s], .title = names[s], .frame_count = 64};
    for (int i = 0; i < PRESETS; i++)
        study->settings[i] = "";
    for (int i = 0; i < SCENES * PRESETS * SEEDS * neph_study_metric_count(); i++) {
        study->cells[i] = (struct neph_study_cell){.value = 1.0, .centre = 1.0, .counts = true};
        for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
            study->cells[i].displays[d] = 1.0;
    }
}

/* One value at all displays. */
static void set(struct neph_flicker_study *study, int scene, int preset, int seed, int metric,
                double value)
{
    struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
    cell->value = value;
    for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
        cell->displays[d] = value;
}

static void assert_text_has(const struct neph_flicker_study *study, const char *part)
{
    struct neph_publication publication;
    begin_published(&publication);
    neph_assert_ok(neph_flicker_publish(study, &publication, NULL), NULL);
    assert_non_null(strstr(published_text(publication.text, &publication), part));
    neph_publication_finish(&publication);
}

/* Seeds with a tenth and ten times the value average to 1. Differences of 0.1 .. 0.4 decades have a
 * mean of 0.25, a standard deviation of sqrt(0.05 / 3), and Student's interval with three degrees
 * of freedom. */
static void test_a_pair_is_students_interval_over_scenes(void **state)
{
    struct neph_flicker_study study;
    struct neph_study_pair pair;
    make_study(&study);
    const int metric = neph_study_find_headline();
    for (int s = 0; s < SCENES; s++)
        for (int seed = 0; seed < SEEDS; seed++) {
            set(&study, s, 0, seed, metric, pow(10.0, 0.1 * (s + 1)) * (seed ? 10.0 : 0.1));
            set(&study, s, 1, seed, metric, seed ? 0.1 : 10.0);
        }
    neph_assert_ok(neph_study_pair(&study, metric, 0, 0, 1, &pair, NULL), NULL);
    const double half = neph_student_critical(0.05, 3.0) * sqrt(0.05 / 3.0) / 2.0;
    assert_int_equal(pair.scene_count, 4);
    neph_assert_close(pair.mean, 0.25, 1e-12, 0.0);
    neph_assert_close(pair.low, 0.25 - half, 1e-9, 0.0);
    neph_assert_close(pair.high, 0.25 + half, 1e-9, 0.0);
    assert_int_equal(pair.worse, 4);
    assert_int_equal(pair.better + pair.alike, 0);
    neph_assert_close(pair.p_sign, 0.125, 1e-12, 0.0);
    assert_int_equal(neph_study_pair_verdict(&pair), 1);
    neph_assert_ok(neph_study_pair(&study, metric, 0, 1, 0, &pair, NULL), NULL);
    assert_int_equal(neph_study_pair_verdict(&pair), -1);
    neph_flicker_study_finish(&study);
}

/* Two values below the least one are equal; a seed that does not count removes its scene. */
static void test_skipped_configurations(void **state)
{
    struct neph_flicker_study study;
    struct neph_study_pair pair;
    make_study(&study);
    const int metric = neph_study_find_headline();
    const double least = neph_study_metrics[metric].least;
    set(&study, 0, 0, 0, metric, 0.0);
    set(&study, 0, 0, 1, metric, 0.9 * least);
    set(&study, 0, 1, 0, metric, 0.1 * least);
    set(&study, 0, 1, 1, metric, least);
    neph_study_cell_at(&study, 1, 1, 1, metric)->counts = false;
    set(&study, 2, 0, 1, metric, 0.5);
    set(&study, 3, 1, 0, metric, NAN);
    neph_assert_ok(neph_study_pair(&study, metric, 0, 0, 1, &pair, NULL), NULL);
    assert_int_equal(pair.scene_count, 2);
    assert_int_equal(pair.alike, 1);
    assert_int_equal(pair.better, 1);
    neph_flicker_study_finish(&study);
}

/* A bound is the least value of both presets: smaller values are equal to it, larger ones are worse
 * by at least the difference. */
static void test_a_bound_keeps_its_scene(void **state)
{
    struct neph_flicker_study study;
    struct neph_study_pair pair;
    make_study(&study);
    const int metric = neph_study_find_headline();
    for (int seed = 0; seed < SEEDS; seed++) {
        set(&study, 0, 0, seed, metric, seed ? 0.5 : 0.3);
        set(&study, 0, 1, seed, metric, 0.2);
        set(&study, 1, 0, seed, metric, 0.01);
        for (int s = 0; s < 2; s++)
            neph_study_cell_at(&study, s, 0, seed, metric)->is_bound = true;
    }
    neph_assert_ok(neph_study_pair(&study, metric, 0, 0, 1, &pair, NULL), NULL);
    assert_int_equal(pair.scene_count, 4);
    assert_int_equal(pair.alike, 3);
    assert_int_equal(pair.better, 1);
    neph_assert_close(pair.mean, -2.0 / 4.0, 1e-12, 0.0);
    assert_text_has(&study, "| two | <0.01 (1) | 1 (1) | 1 (1) |");
    neph_flicker_study_finish(&study);
}

/* Without a common scene there is no value, and with one no interval. */
static void test_few_scenes_have_no_interval(void **state)
{
    struct neph_flicker_study study;
    struct neph_study_pair pair;
    make_study(&study);
    for (int s = 0; s < SCENES; s++) {
        const int metric = neph_study_find_headline();
        neph_study_cell_at(&study, s, 0, 0, metric)->counts = s == 3;
        neph_assert_ok(neph_study_pair(&study, metric, 0, 0, 1, &pair, NULL), NULL);
        if (s < SCENES - 1)
            continue;
        assert_int_equal(pair.scene_count, 1);
        assert_false(pair.has_interval);
        assert_int_equal(neph_study_pair_verdict(&pair), 0);
        neph_study_cell_at(&study, s, 0, 0, metric)->counts = false;
        neph_assert_ok(neph_study_pair(&study, metric, 0, 0, 1, &pair, NULL), NULL);
        assert_int_equal(pair.scene_count, 0);
        assert_true(isnan(pair.mean));
    }
    neph_flicker_study_finish(&study);
}

/* c is best, then a, then b, at all displays but one, where a is best. Differences between scenes
 * do not widen the interval of a preset: here all scenes agree on the differences between presets.
 */
static void test_a_ranking_that_turns_with_the_display_is_none(void **state)
{
    static const double relative[PRESETS] = {1.0, 2.0, 0.5};
    struct neph_flicker_study study;
    struct neph_study_level levels[PRESETS];
    int order[PRESETS];
    make_study(&study);
    const int metric = neph_study_find_headline();
    for (int s = 0; s < SCENES; s++)
        for (int preset = 0; preset < PRESETS; preset++)
            for (int seed = 0; seed < SEEDS; seed++)
                set(&study, s, preset, seed, metric, relative[preset] * pow(10.0, s));
    neph_assert_ok(neph_study_levels(&study, metric, 0, levels, NULL), NULL);
    for (int preset = 0; preset < PRESETS; preset++) {
        neph_assert_close(levels[preset].mean, 1.5 + log10(relative[preset]), 1e-12, 0.0);
        assert_int_equal(levels[preset].scene_count, SCENES);
        if (levels[preset].has_interval) /* rounding */
            neph_assert_close(levels[preset].low, levels[preset].high, 1e-12, 0.0);
    }
    neph_assert_ok(neph_study_ranking(&study, 0, order, NULL), NULL);
    assert_true(order[0] == 2 && order[1] == 0 && order[2] == 1);
    assert_text_has(&study, "The order is the same at all 6 displays.");
    for (int s = 0; s < SCENES; s++)
        for (int seed = 0; seed < SEEDS; seed++)
            neph_study_cell_at(&study, s, 0, seed, metric)->displays[4] = 1e-2;
    assert_text_has(&study, "The order is the same at 5 of 6 displays: it is not a ranking.");
    neph_flicker_study_finish(&study);
}

/* ---- output ---------------------------------------------------------------------------------- */

static void test_output_has_numbers_and_reasons(void **state)
{
    struct neph_flicker_study study;
    struct neph_publication publication;
    make_study(&study);
    const int metric = neph_study_find_headline(),
              count = SCENES * PRESETS * SEEDS * neph_study_metric_count();
    struct neph_study_cell *cell = neph_study_cell_at(&study, 2, 1, 0, metric);
    cell->counts = false;
    snprintf(cell->because, sizeof(cell->because), "reference-limited: for a test");
    begin_published(&publication);
    neph_assert_ok(neph_flicker_publish(&study, &publication, NULL), NULL);
    const char *text = published_text(publication.text, &publication);
    assert_non_null(strstr(text, "three, b+\"x\"=1: reference-limited: for a test."));
    assert_non_null(strstr(text, "| three | 1 (1) | *1 (1) | 1 (1) |"));
    assert_non_null(strstr(text, "64 frames resolve periods of 2 to 8 frames"));
    const char *csv = published_text(publication.csv, &publication);
    assert_int_equal(count_parts(csv, "\r\n"), 1 + count);
    assert_non_null(strstr(csv, "three,\"b+\"\"x\"\"=1\",1,"));
    const char *svg = published_text(publication.chart, &publication);
    assert_int_equal(count_parts(svg, "<circle"), PRESETS);
    assert_non_null(strstr(svg, "c&#60;d"));
    assert_non_null(publication.json);
    assert_int_equal(json_array_size(json_object_get(publication.json, "results")), count);
    neph_publication_finish(&publication);
    neph_flicker_study_finish(&study);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Floors of flicker studies without a renderer: their configurations, and ratios from synthetic
 * values.
 */
#include "tests/harness/published.h"

#include "harness/engines/engines.h"
#include "harness/experiments/flicker.h"
#include "harness/study/flicker_pairs.h"
#include "harness/study/floor_plan.h"
#include "metrics/significance.h"
#include "renderer/realtime/options.h"

/* ---- configurations -------------------------------------------------------------------------- */

static struct neph_settings parse_settings(const char *words)
{
    const struct neph_engine *engine;
    struct neph_settings settings;
    neph_assert_ok(neph_engine_parse_words(words, "steps=8", &engine, &settings, NULL), NULL);
    return settings;
}

/* The names of the anti-aliasing's settings begin with taa, and no other ones do. */
static void test_the_group_has_all_settings_of_the_anti_aliasing(void **state)
{
    int count = 0;
    for (int i = 0; i < RT_SETTING_COUNT; i++) {
        const bool is_in_group = strcmp(neph_rt_option_groups[i], "anti aliasing") == 0;
        if (is_in_group != (strncmp(neph_rt_options[i].name, "taa", 3) == 0))
            fail_msg("%s is in group %s", neph_rt_options[i].name, neph_rt_option_groups[i]);
        count += is_in_group;
    }
    assert_true(count > 10);
}

static void make_plan(const char *const *presets, int count, struct neph_arena *arena,
                      struct neph_floor_plan *plan)
{
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_floor_plan_make(presets, count, 8, arena, plan, &diag), &diag);
    assert_int_equal(plan->preset_count, count);
}

/* A floor of each preset of the renderer has the anti-aliasing of the preset or the default one,
 * the march of the preset, and else the settings of `off`. */
static void test_a_floor_is_off_with_an_anti_aliasing(void **state)
{
    const struct neph_settings off = parse_settings("off"), fixed = parse_settings("fixed");
    for (const struct neph_preset *preset = neph_rt_presets; preset->name; preset++) {
        struct neph_arena arena = {.last = NULL};
        struct neph_floor_plan plan;
        make_plan(&preset->name, 1, &arena, &plan);
        const struct neph_settings of_preset = parse_settings(preset->name);
        for (int c = 0; c < NEPH_STUDY_FLOOR_CANDIDATES; c++) {
            const char *words = plan.words[plan.floors[0].candidates[c]];
            const struct neph_settings floor = parse_settings(words);
            const struct neph_settings *taa = c == 0 ? &of_preset : &fixed;
            for (int i = 0; i < RT_SETTING_COUNT; i++) {
                const char *group = neph_rt_option_groups[i];
                const struct neph_settings *of = strcmp(group, "anti aliasing") == 0 ? taa
                                                 : strcmp(group, "march") == 0       ? &of_preset
                                                                                     : &off;
                if (memcmp(&floor.values[i], &of->values[i], sizeof(floor.values[i])) != 0)
                    fail_msg("%s, floor %s: %s", preset->name, words, neph_rt_options[i].name);
            }
        }
        neph_arena_finish(&arena);
    }
}

/* Presets with the same anti-aliasing share their floors, and a preset can be a floor. */
static void test_each_floor_is_there_once(void **state)
{
    static const char *const presets[] = {"fixed",      "seed", "ue",
                                          "off+taa=on", "off",  "ours+steps=64"};
    enum { COUNT = sizeof(presets) / sizeof(presets[0]) };
    struct neph_arena arena = {.last = NULL};
    struct neph_floor_plan plan;
    make_plan(presets, COUNT, &arena, &plan);
    const struct neph_study_floor *floors = plan.floors;
    assert_int_equal(floors[0].candidates[0], 3);
    assert_int_equal(floors[0].candidates[1], 3);
    assert_int_equal(floors[1].candidates[0], COUNT);
    assert_string_equal(plan.words[COUNT], "off+taa=on+taa_jitter_length=8");
    assert_int_equal(floors[1].candidates[1], 3);
    assert_memory_equal(&floors[1], &floors[2], sizeof(floors[0]));
    assert_memory_equal(&floors[3], &floors[0], sizeof(floors[0]));
    assert_int_equal(floors[4].candidates[0], 4);
    assert_int_equal(floors[4].candidates[1], 3);
    assert_int_equal(plan.floor_count, 3); /* and two of 64 steps */
    assert_string_equal(plan.words[floors[5].candidates[1]], "off+steps=64+taa=on");
    neph_arena_finish(&arena);
}

static void test_floors_refuse_an_unknown_preset(void **state)
{
    static const char *const presets[] = {"nope"};
    struct neph_arena arena = {.last = NULL};
    struct neph_floor_plan plan;
    assert_int_equal(neph_floor_plan_make(presets, 1, 8, &arena, &plan, NULL), NEPH_ERR_USAGE);
    neph_arena_finish(&arena);
}

/* ---- ratios ---------------------------------------------------------------------------------- */

/* Preset "ours" has the floors "own" and "plain"; preset "plain" is its own floor. */
enum { OURS, PLAIN, OWN, CONFIGURATIONS, PRESETS = 2, SCENES = 4, SEEDS = 2 };

static const char *const configurations[CONFIGURATIONS] = {"ours", "plain", "own"};
static const struct neph_study_floor floors[PRESETS] = {{{OWN, PLAIN}}, {{PLAIN, PLAIN}}};
static const struct neph_flicker_study_params with_floors = {
    .presets = configurations,
    .preset_count = PRESETS,
    .floor_count = CONFIGURATIONS - PRESETS,
    .floors = floors,
    .scene_count = SCENES,
    .seed_count = SEEDS,
    .frame_count = 64,
    .steps = 8,
    .width_px = 16,
    .height_px = 9,
    .takes = {true, true, true, true},
};

/* Every cell counts and is 1. */
static void make_study(const struct neph_flicker_study_params *params,
                       struct neph_flicker_study *study)
{
    static const char *const names[SCENES] = {"one", "two", "three", "four"};
    const int count = SCENES * (params->preset_count + params->floor_count) * SEEDS *
                      neph_study_metric_count();
    neph_assert_ok(neph_flicker_study_begin(params, study, NULL), NULL);
    for (int s = 0; s < SCENES; s++)
        study->scenes[s] = (struct neph_study_scene){
            .name = names[s], .title = names[s], .frame_count = 64};
    for (int i = 0; i < CONFIGURATIONS; i++)
        study->settings[i] = "";
    for (int i = 0; i < count; i++) {
        study->cells[i] = (struct neph_study_cell){.value = 1.0, .centre = 1.0, .counts = true};
        for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
            study->cells[i].displays[d] = 1.0;
    }
}

/* The values of a scene: seeds a tenth and ten times `value`, with that geometric mean. */
static void set(struct neph_flicker_study *study, int scene, int configuration, int metric,
                double value)
{
    for (int seed = 0; seed < SEEDS; seed++) {
        struct neph_study_cell *cell = neph_study_cell_at(study, scene, configuration, seed,
                                                          metric);
        cell->value = value * (seed ? 10.0 : 0.1);
        for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
            cell->displays[d] = cell->value;
    }
}

static struct neph_study_gap find_gap(const struct neph_flicker_study *study, int metric,
                                      int preset)
{
    struct neph_study_gap gap;
    neph_assert_ok(neph_study_gap(study, metric, 0, preset, &gap, NULL), NULL);
    return gap;
}

/* "ours" is 10^0.1, 10^0.2, 10^0.3, 10^0.4 times the lower floor, which is "own" and "plain" by
 * turns; the other floor is far higher. Decades have a mean of 0.25, a standard deviation of
 * sqrt(0.05 / 3), and Student's interval with three degrees of freedom. */
static void test_the_floor_is_the_lower_one_of_each_scene(void **state)
{
    struct neph_flicker_study study;
    make_study(&with_floors, &study);
    const int metric = neph_study_find_headline();
    double sum = 0.0;
    for (int s = 0; s < SCENES; s++) {
        const double low = 0.5 + s;
        set(&study, s, s % 2 ? OWN : PLAIN, metric, low);
        set(&study, s, s % 2 ? PLAIN : OWN, metric, 30.0 * low);
        set(&study, s, OURS, metric, pow(10.0, 0.1 * (s + 1)) * low);
        sum += log10(low);
        const struct neph_study_scene_gap gap = neph_study_scene_gap(&study, metric, 0, OURS, s);
        assert_int_equal(gap.lower, s % 2 ? OWN : PLAIN);
        neph_assert_close(gap.preset - gap.floor, 0.1 * (s + 1), 1e-12, 0.0);
    }
    const double half = neph_student_critical(0.05, 3.0) * sqrt(0.05 / 3.0) / 2.0;
    const struct neph_study_gap gap = find_gap(&study, metric, OURS);
    assert_int_equal(gap.pair.scene_count, SCENES);
    neph_assert_close(gap.pair.mean, 0.25, 1e-12, 0.0);
    neph_assert_close(gap.pair.low, 0.25 - half, 1e-9, 0.0);
    neph_assert_close(gap.pair.high, 0.25 + half, 1e-9, 0.0);
    neph_assert_close(gap.floor, sum / SCENES, 1e-12, 0.0);
    neph_assert_close(gap.preset, sum / SCENES + 0.25, 1e-12, 0.0);
    assert_int_equal(gap.pair.worse, SCENES);
    neph_flicker_study_finish(&study);
}

static void test_a_preset_that_is_its_floor_has_a_ratio_of_one(void **state)
{
    struct neph_flicker_study study;
    make_study(&with_floors, &study);
    for (int metric = 0; neph_study_metrics[metric].title; metric++) {
        for (int s = 0; s < SCENES; s++)
            set(&study, s, PLAIN, metric, 0.3 * s + 0.7 / (metric + 1.0));
        const struct neph_study_gap gap = find_gap(&study, metric, PLAIN);
        assert_int_equal(gap.pair.scene_count, SCENES);
        assert_true(pow(10.0, gap.pair.mean) == 1.0);
        assert_true(gap.pair.has_interval && gap.pair.low == 0.0 && gap.pair.high == 0.0);
        assert_int_equal(gap.pair.alike, SCENES);
    }
    neph_flicker_study_finish(&study);
}

/* A worse anti-aliasing in the preset's floor leaves the ratio as it is; a better one raises it. */
static void test_a_worse_anti_aliasing_flatters_no_ratio(void **state)
{
    struct neph_flicker_study study;
    make_study(&with_floors, &study);
    const int metric = neph_study_find_headline();
    for (int s = 0; s < SCENES; s++) {
        set(&study, s, OURS, metric, 3.0);
        set(&study, s, PLAIN, metric, 1.0);
        set(&study, s, OWN, metric, 100.0);
    }
    neph_assert_close(find_gap(&study, metric, OURS).pair.mean, log10(3.0), 1e-12, 0.0);
    for (int s = 0; s < SCENES; s++)
        set(&study, s, OWN, metric, 0.5);
    neph_assert_close(find_gap(&study, metric, OURS).pair.mean, log10(6.0), 1e-12, 0.0);
    neph_flicker_study_finish(&study);
}

/* Without a value of one candidate a scene has no floor; a bound of one is the least value of all
 * three. */
static void test_scenes_without_a_floor_and_bounds(void **state)
{
    struct neph_flicker_study study;
    make_study(&with_floors, &study);
    const int metric = neph_study_find_headline();
    neph_study_cell_at(&study, 0, OWN, 1, metric)->counts = false;
    neph_study_cell_at(&study, 1, PLAIN, 0, metric)->counts = false;
    for (int seed = 0; seed < SEEDS; seed++) {
        struct neph_study_cell *cell = neph_study_cell_at(&study, 2, OWN, seed, metric);
        cell->value = cell->displays[0] = 10.0;
        cell->is_bound = true;
    }
    assert_int_equal(neph_study_scene_gap(&study, metric, 0, OURS, 0).lower, -1);
    assert_int_equal(neph_study_scene_gap(&study, metric, 0, OURS, 1).lower, -1);
    const struct neph_study_gap gap = find_gap(&study, metric, OURS);
    assert_int_equal(gap.pair.scene_count, 2);
    assert_int_equal(gap.pair.alike, 2);
    neph_assert_close(gap.preset, 0.5, 1e-12, 0.0);
    neph_flicker_study_finish(&study);
}

/* Floors change neither pairs nor levels nor the order of presets. */
static void test_floors_take_no_part_in_the_comparison(void **state)
{
    struct neph_flicker_study_params without = with_floors;
    struct neph_flicker_study study, bare;
    struct neph_study_pair pairs[2];
    struct neph_study_level levels[2][PRESETS];
    without.floors = NULL;
    without.floor_count = 0;
    make_study(&with_floors, &study);
    make_study(&without, &bare);
    const int metric = neph_study_find_headline();
    for (int s = 0; s < SCENES; s++)
        for (int preset = 0; preset < PRESETS; preset++) {
            set(&study, s, preset, metric, 1.0 + s + 0.3 * preset * s);
            set(&bare, s, preset, metric, 1.0 + s + 0.3 * preset * s);
            set(&study, s, OWN, metric, 1e-3);
        }
    for (int i = 0; i < 2; i++) {
        const struct neph_flicker_study *of = i ? &bare : &study;
        neph_assert_ok(neph_study_pair(of, metric, 0, 0, 1, &pairs[i], NULL), NULL);
        neph_assert_ok(neph_study_levels(of, metric, 0, levels[i], NULL), NULL);
    }
    assert_true(pairs[0].mean == pairs[1].mean && pairs[0].low == pairs[1].low);
    for (int preset = 0; preset < PRESETS; preset++)
        assert_true(levels[0][preset].mean == levels[1][preset].mean &&
                    levels[0][preset].low == levels[1][preset].low);
    assert_int_equal(find_gap(&bare, metric, OURS).pair.scene_count, 0);
    neph_flicker_study_finish(&study);
    neph_flicker_study_finish(&bare);
}

/* ---- output ---------------------------------------------------------------------------------- */

static void check_documents(const struct neph_publication *publication)
{
    const int rows = SCENES * SEEDS * neph_study_metric_count();
    const char *csv = published_text(publication->csv, publication);
    assert_int_equal(count_parts(csv, "\r\n"), 1 + CONFIGURATIONS * rows);
    assert_int_equal(count_parts(csv, ",own,1,0.5\r\n"), SEEDS * SCENES);
    assert_int_equal(count_parts(csv, ",1,,,\r\n"), rows);
    const char *svg = published_text(publication->chart, publication);
    assert_int_equal(count_parts(svg, "<circle"), PRESETS);
    assert_int_equal(count_parts(svg, "stroke-width=\"2\""), PRESETS);
    assert_non_null(strstr(svg, ">floor of ours</text>"));
    const json_t *ratio = json_array_get(json_object_get(publication->json, "times_floor"), 0);
    assert_string_equal(json_string_value(json_object_get(ratio, "preset")), "ours");
    neph_assert_close(json_real_value(json_object_get(ratio, "times")), 0.5, 1e-12, 0.0);
    neph_assert_close(json_real_value(json_object_get(ratio, "floor")), 1.0, 1e-12, 0.0);
    assert_int_equal(json_array_size(json_object_get(publication->json, "floors")), PRESETS);
    assert_int_equal(json_array_size(json_object_get(publication->json, "presets")), PRESETS);
}

/* "ours" has half of the flicker of its floor, which is "own"; "plain" has 3. */
static void test_a_number_stands_beside_its_floor(void **state)
{
    struct neph_flicker_study study;
    struct neph_publication publication;
    make_study(&with_floors, &study);
    const int metric = neph_study_find_headline();
    for (int s = 0; s < SCENES; s++)
        for (int seed = 0; seed < SEEDS; seed++)
            for (int i = 0; i < CONFIGURATIONS; i++) {
                static const double values[CONFIGURATIONS] = {0.5, 3.0, 1.0};
                struct neph_study_cell *cell = neph_study_cell_at(&study, s, i, seed, metric);
                cell->value = values[i];
                for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
                    cell->displays[d] = values[i];
            }
    begin_published(&publication);
    neph_assert_ok(neph_flicker_publish(&study, &publication, NULL), NULL);
    const char *text = published_text(publication.text, &publication);
    assert_non_null(strstr(text, "- floor of ours: own or plain\n- floor of plain: plain\n"));
    assert_non_null(strstr(text, "| scene | ours | plain | floor of ours | floor of plain |"));
    assert_non_null(strstr(text, "| two | 0.5 (1) | 3 (1) | 1 (1) | 3 (1) |"));
    assert_non_null(strstr(text, "| ours | 0.5 | 1 | 0.5 | 0.5 to 0.5 | 4 | 4, 0, 0 |"));
    assert_non_null(strstr(text, "| plain | 3 | 3 | 1 | 1 to 1 | 4 | 0, 0, 4 | 1 |"));
    check_documents(&publication);
    const char *const *lines = publication.answer.lines;
    assert_non_null(strstr(lines[0], "ours 0.5 (floor 1), plain 3 (floor 3): 0.167 times"));
    assert_non_null(strstr(lines[1], ": ours 0.5, floor 1: 0.5 times (0.5 to 0.5)"));
    assert_string_equal(lines[2], "ours over its floor: error 1 times (1 to 1), half-life 1 times "
                                  "(1 to 1), lag 1 times (1 to 1), ghosts 1 times (1 to 1)");
    neph_publication_finish(&publication);
    neph_flicker_study_finish(&study);
}

static void test_a_study_without_floors_says_so(void **state)
{
    struct neph_flicker_study_params without = with_floors;
    struct neph_flicker_study study;
    struct neph_publication publication;
    without.floors = NULL;
    without.floor_count = 0;
    make_study(&without, &study);
    begin_published(&publication);
    neph_assert_ok(neph_flicker_publish(&study, &publication, NULL), NULL);
    assert_string_equal(publication.answer.lines[1], "without floors (--no-floor)");
    assert_non_null(
        strstr(published_text(publication.text, &publication), "Without floors (--no-floor)."));
    assert_int_equal(json_array_size(json_object_get(publication.json, "times_floor")), 0);
    neph_publication_finish(&publication);
    neph_flicker_study_finish(&study);
}

#include "tests/main.h"

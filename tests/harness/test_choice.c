/* SPDX-License-Identifier: MIT
 *
 * Choosing a preset without a renderer: levels, fronts, budgets, ties.
 */
#include "tests/neph_test.h"

#include "harness/engines/engines.h"
#include "harness/sweep/choice.h"

#include <math.h>

/* Flicker, half-life, lag, error, evaluations, ms. */
static struct neph_choice make_choice(int count, const double levels[][NEPH_CHOICE_NUMBERS])
{
    struct neph_choice choice = {.candidate_count = count, .least = NEPH_CHOICE_WORK};
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++) {
        choice.budget[n] = NAN;
        choice.scene_counts[n] = 3;
        for (int i = 0; i < count; i++)
            choice.candidates[i].levels[n] = levels[i][n];
    }
    return choice;
}

static const double some[][NEPH_CHOICE_NUMBERS] = {
    {4, 2, 3, 0.05, 0.40, 9}, /* quick */
    {2, 4, 5, 0.05, 0.40, 1}, /* steady */
    {4, 4, 5, 0.05, 0.40, 9}, /* dominated by both */
    {3, 3, 4, 0.04, 0.50, 9}, /* more expensive */
};

static void test_the_front_and_its_best_points(void **state)
{
    struct neph_choice choice = make_choice(4, some);
    neph_choice_judge(&choice);
    assert_true(choice.candidates[0].on_front && choice.candidates[1].on_front);
    assert_false(choice.candidates[2].on_front);
    assert_true(choice.candidates[3].on_front);
    assert_int_equal(choice.candidates[2].beaten_by, 0);
    assert_int_equal(choice.candidates[0].beaten_by, -1);
}

static void test_budgets_and_the_least(void **state)
{
    struct neph_choice choice = make_choice(4, some);
    /* With equal evaluations the smallest product of all levels decides. */
    neph_choice_judge(&choice);
    assert_int_equal(choice.chosen, 0);
    choice.budget[NEPH_CHOICE_FLICKER] = 3.0;
    neph_choice_judge(&choice);
    assert_int_equal(choice.chosen, 1);
    choice.budget[NEPH_CHOICE_HALF_LIFE] = 3.5;
    neph_choice_judge(&choice);
    assert_int_equal(choice.chosen, 3);
    choice.budget[NEPH_CHOICE_HALF_LIFE] = NAN;
    choice.least = NEPH_CHOICE_ERROR;
    neph_choice_judge(&choice);
    assert_int_equal(choice.chosen, 3);
    choice.budget[NEPH_CHOICE_FLICKER] = 1.5; /* candidate 2 is the nearest */
    neph_choice_judge(&choice);
    assert_int_equal(choice.chosen, -1);
    assert_int_equal(choice.nearest, 1);
    assert_false(choice.candidates[1].is_within);
}

/* Measures that are not requested, or that no scene has, do not count. */
static void test_time_is_weighed_on_request(void **state)
{
    static const double two[][NEPH_CHOICE_NUMBERS] = {{1, 1, 1, 1, 1, 9}, {1, 1, 1, 2, 1, 1}};
    struct neph_choice choice = make_choice(2, two);
    neph_choice_judge(&choice);
    assert_false(choice.candidates[1].on_front);
    choice.budget[NEPH_CHOICE_TIME] = 5.0;
    neph_choice_judge(&choice);
    assert_true(choice.candidates[1].on_front);
    assert_int_equal(choice.chosen, 1);
    choice = make_choice(2, two);
    choice.scene_counts[NEPH_CHOICE_ERROR] = 0;
    neph_choice_judge(&choice);
    assert_true(choice.candidates[1].on_front);
}

/* --- levels --------------------------------------------------------------------------------- */

enum { PRESETS = 2, SCENES = 3 };

static void test_levels_are_geometric_means(void **state)
{
    static const char *const presets[] = {"ours", "fixed"}, *const scenes[] = {"a", "b", "c"};
    const struct neph_flicker_study_params params = {.presets = presets,
                                                     .preset_count = PRESETS,
                                                     .scenes = scenes,
                                                     .scene_count = SCENES,
                                                     .seed_count = 1,
                                                     .steps = 8};
    struct neph_study_scene rows[SCENES] = {
        {.name = (char[]){"a"}}, {.name = (char[]){"b"}}, {.name = (char[]){"c"}}};
    const size_t cells = (size_t)PRESETS * SCENES * (size_t)neph_study_metric_count();
    struct neph_flicker_study study = {.params = &params,
                                       .scenes = rows,
                                       .cells = calloc(cells, sizeof(*study.cells)),
                                       .costs = calloc(PRESETS * SCENES, sizeof(*study.costs))};
    assert_non_null(study.cells);
    assert_non_null(study.costs);
    for (int scene = 0; scene < SCENES; scene++)
        for (int preset = 0; preset < PRESETS; preset++) {
            const double value = (preset + 1) * pow(10.0, scene);
            for (int m = 0; m < neph_study_metric_count(); m++)
                *neph_study_cell_at(&study, scene, preset, 0, m) = (struct neph_study_cell){
                    .value = value, .displays = {value}, .counts = true};
            *neph_study_cost_at(&study, scene, preset, 0) = (struct neph_study_cost){
                scene == 2 && preset ? NAN : value, 1.0, NAN, NAN, NULL};
        }
    struct neph_choice choice = {.least = NEPH_CHOICE_FLICKER};
    struct neph_diag diag = {.line = 0};
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        choice.budget[n] = NAN;
    neph_assert_ok(neph_choice_make(&study, &choice, &diag), &diag);
    for (int n = 0; n < NEPH_CHOICE_WORK; n++) {
        assert_int_equal(choice.scene_counts[n], SCENES);
        assert_true(fabs(choice.candidates[0].levels[n] - 10.0) < 1e-9);
        assert_true(fabs(choice.candidates[1].levels[n] - 20.0) < 1e-9);
    }
    assert_int_equal(choice.scene_counts[NEPH_CHOICE_WORK], 2); /* scenes that both have */
    assert_true(fabs(choice.candidates[0].levels[NEPH_CHOICE_WORK] - sqrt(10.0)) < 1e-9);
    assert_int_equal(choice.scene_counts[NEPH_CHOICE_TIME], 0);
    assert_int_equal(choice.chosen, 0);
    assert_int_equal(choice.candidates[1].beaten_by, 0);
    json_t *json = neph_choice_json(&choice, &study);
    assert_string_equal(neph_json_text(json, "preset"), "ours");
    assert_string_equal(neph_json_text(json, "engine"), "realtime");
    assert_non_null(strstr(neph_json_text(json, "settings"), "steps=8 "));
    json_decref(json);
    free(study.costs);
    free(study.cells);
}

/* --- words ---------------------------------------------------------------------------------- */

static void test_presets_and_guests_in_words(void **state)
{
    const struct neph_engine *engine = NULL;
    struct neph_settings settings;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_engine_parse_words("fixed+taa=off", "steps=9", &engine, &settings, &diag),
                   &diag);
    assert_string_equal(engine->name, "realtime");
    assert_true(neph_setting(engine, &settings, "steps") == 9.0);
    neph_assert_ok(
        neph_engine_parse_words("command+a=0.5+b=2", "steps=9", &engine, &settings, &diag), &diag);
    assert_string_equal(engine->name, "command");
    assert_true(neph_setting(engine, &settings, "a") == 0.5);
    assert_true(neph_setting(engine, &settings, "b") == 2.0);
    assert_int_equal(neph_engine_parse_words("command+e=1", NULL, &engine, &settings, &diag),
                     NEPH_ERR_USAGE);
    assert_int_equal(neph_engine_parse_words("commander", NULL, &engine, &settings, &diag),
                     NEPH_ERR_USAGE);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Ablations without a renderer: the table of parts matches the presets, and effects and verdicts
 * are computed correctly from synthetic values.
 */
#include "tests/harness/published.h"

#include "base/written.h"
#include "harness/engines/engines.h"
#include "harness/experiments/ablation.h"
#include "metrics/significance.h"

/* ---- parts ----------------------------------------------------------------------------------- */

static neph_ablation_set bit(const char *name)
{
    const int part = neph_ablation_part_find(name);
    assert_true(part >= 0);
    return (neph_ablation_set)1 << part;
}

static neph_ablation_set find_preset_parts(const char *preset)
{
    neph_ablation_set parts = 0;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_ablation_find_parts(preset, &parts, &diag), &diag);
    return parts;
}

static struct neph_settings parse_test_settings(const char *words)
{
    struct neph_settings settings;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(
        neph_settings_parse_words(neph_engine_find("realtime"), words, "steps=8", &settings, &diag),
        &diag);
    return settings;
}

static struct neph_settings settings_without(const char *preset, neph_ablation_set without)
{
    struct neph_arena arena = {.last = NULL};
    const struct neph_settings settings = parse_test_settings(
        neph_ablation_words(&arena, preset, without));
    neph_arena_finish(&arena);
    return settings;
}

static neph_ablation_set every_part(void)
{
    return ((neph_ablation_set)1 << neph_ablation_part_count()) - 1;
}

static void test_parts_name_settings_and_each_other(void **state)
{
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        const struct neph_ablation_part *part = &neph_ablation_parts[i];
        assert_int_equal(neph_ablation_part_find(part->name), i);
        assert_true(strlen(part->what) > 0 && strlen(part->claim) > 0);
        if (part->needs)
            assert_true(neph_ablation_part_find(part->needs) >= 0);
        assert_true((neph_ablation_with_needs(i) & bit(part->name)) != 0);
        settings_without("ours", bit(part->name));
    }
    assert_int_equal(neph_ablation_part_find("none"), -1);
    assert_true(neph_ablation_with_needs(neph_ablation_part_find("gradients")) ==
                (bit("gradients") | bit("box") | bit("history")));
}

/* No two parts of the plain pipeline share a setting; one part would switch the other. */
static void test_parts_of_the_plain_pipeline_keep_apart(void **state)
{
    int owners[NEPH_OPTIONS_MAX] = {0};
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        if (neph_ablation_parts[i].stays)
            continue;
        char *text = strdup(neph_ablation_parts[i].off), *rest = text;
        while (rest) {
            const char *word = strsep(&rest, "+=");
            const int option = neph_option_find(neph_engine_find("realtime")->options, word);
            assert_true(option >= 0);
            assert_int_equal(owners[option]++, 0);
            assert_non_null(strsep(&rest, "+"));
        }
        free(text);
    }
}

static neph_ablation_set second_generation(void)
{
    return bit("true_gradient") | bit("rest") | bit("relight") | bit("change_memory") |
           bit("own_depth") | bit("medium_motion") | bit("running_mean") | bit("stand_in");
}

/* Parts of the third generation. */
static neph_ablation_set third_generation(void)
{
    return bit("kept_frames") | bit("wide_change");
}

/* Parts that are in no preset and are set for scenes that need them. */
static neph_ablation_set of_the_air(void)
{
    return bit("froxels") | bit("froxel_jitter") | bit("froxel_history") | bit("froxel_hold") |
           bit("cloud_map") | bit("map_columns");
}

static void test_ours_has_every_part_but_the_dithered_upscale(void **state)
{
    assert_true(find_preset_parts("ours1") ==
                (every_part() & ~bit("upscale_dither") & ~second_generation() &
                 ~third_generation() & ~of_the_air()));
    assert_true(find_preset_parts("ours2") ==
                ((find_preset_parts("ours1") | second_generation()) & ~third_generation()));
    assert_true(find_preset_parts("ours") == (find_preset_parts("ours2") | third_generation()));
    assert_true((find_preset_parts("fixed") & bit("upscale_dither")) != 0);
    assert_true((find_preset_parts("fixed") & bit("gradients")) == 0);
    assert_true((find_preset_parts("ours+override=none") & bit("override")) == 0);
    assert_true((find_preset_parts("ours+box=none") &
                 (bit("box") | bit("own_ray") | bit("gradients"))) == 0);
    neph_ablation_set parts;
    assert_int_equal(neph_ablation_find_parts("nope", &parts, NULL), NEPH_ERR_USAGE);
}

/* Froxels and cloud shadow maps are enabled by a setting, with all parts that need them. */
static void test_parts_of_the_air_are_requested(void **state)
{
    const neph_ablation_set froxels = bit("froxels") | bit("froxel_jitter") |
                                      bit("froxel_history") | bit("froxel_hold");
    assert_true((find_preset_parts("ours+froxels=on") & of_the_air()) == froxels);
    assert_true((find_preset_parts("ours+froxels=on+froxel_jitter=off") & of_the_air()) ==
                (froxels & ~bit("froxel_jitter")));
    assert_true((find_preset_parts("fixed+cloud_shadow=map") & of_the_air()) ==
                (of_the_air() & ~froxels));
    const struct neph_settings without = settings_without("ours+froxels=on", froxels);
    const int option = neph_option_find(neph_engine_find("realtime")->options, "froxels");
    assert_true(without.values[option] == 0.0);
}

/* Without all parts, only those marked `stays` remain. */
static void test_the_plain_pipeline_has_no_part(void **state)
{
    neph_ablation_set stays = 0;
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (neph_ablation_parts[i].stays)
            stays |= (neph_ablation_set)1 << i;
    struct neph_arena arena = {.last = NULL};
    const char *plain = neph_ablation_words(&arena, "ours", every_part() & ~stays);
    assert_true(find_preset_parts(plain) ==
                bit("split")); /* the clamp of the anti-aliasing needs it */
    neph_arena_finish(&arena);
}

static bool is_exception(const char *option)
{
    for (int i = 0; neph_ablation_exceptions[i].option; i++)
        if (strcmp(neph_ablation_exceptions[i].option, option) == 0)
            return true;
    return false;
}

/* Without all parts a preset has the plain values of the parts' settings. So every setting in which
 * `ours` differs from another preset belongs to a part or is a listed exception. */
static void test_no_setting_of_ours_is_forgotten(void **state)
{
    static const char *const others[] = {"seed", "fixed", "ours1", "ours2"};
    const struct neph_option *options = neph_engine_find("realtime")->options;
    const struct neph_settings ours = parse_test_settings("ours");
    int difference_count = 0;
    for (size_t other = 0; other < COUNT(others); other++) {
        const struct neph_settings theirs = parse_test_settings(others[other]);
        const struct neph_settings a = settings_without("ours", every_part());
        const struct neph_settings b = settings_without(others[other], every_part());
        for (int i = 0; options[i].name; i++) {
            difference_count += ours.values[i] != theirs.values[i];
            if (a.values[i] != b.values[i] && !is_exception(options[i].name))
                fail_msg("'ours' and '%s' differ in %s, which no part has", others[other],
                         options[i].name);
        }
    }
    assert_true(difference_count > 20);
    for (int i = 0; neph_ablation_exceptions[i].option; i++) {
        assert_true(neph_option_find(options, neph_ablation_exceptions[i].option) >= 0);
        assert_true(strlen(neph_ablation_exceptions[i].reason) > 0);
    }
}

/* ---- plans ----------------------------------------------------------------------------------- */

enum { SCENES = 4, SEEDS = 2 };

static void plan(struct neph_ablation *ablation, const char *const *only, int count)
{
    struct neph_diag diag = {.line = 0};
    *ablation = (struct neph_ablation){.preset = NULL};
    neph_assert_ok(neph_ablation_plan("ours", only, count, ablation, &diag), &diag);
}

/* The preset, the plain pipeline, and each part in both places; a configuration that several parts
 * need appears once. */
static void test_a_plan_has_each_configuration_once(void **state)
{
    static const char *const only[] = {"history", "box", "split"};
    struct neph_ablation ablation;
    plan(&ablation, only, 3);
    assert_int_equal(ablation.configuration_count, 2 + 2 + 2 + 1);
    assert_int_equal(ablation.comparison_count, 1 + 2 + 2 + 1);
    assert_string_equal(ablation.words[0], "ours");
    const struct neph_ablation_comparison *history, *box, *split;
    history = neph_ablation_find(&ablation, neph_ablation_part_find("history"),
                                 NEPH_ABLATION_ALONE);
    box = neph_ablation_find(&ablation, neph_ablation_part_find("box"), NEPH_ABLATION_ALONE);
    split = neph_ablation_find(&ablation, neph_ablation_part_find("split"),
                               NEPH_ABLATION_IN_PRESET);
    assert_int_equal(history->without, 1); /* plain */
    assert_int_equal(box->without, history->with);
    assert_string_equal(ablation.words[split->without], "ours+split=none");
    assert_null(neph_ablation_find(&ablation, split->part, NEPH_ABLATION_ALONE));
    assert_true(find_preset_parts(ablation.words[box->with]) ==
                (bit("split") | bit("history") | bit("box")));
    neph_ablation_finish(&ablation);
    plan(&ablation, NULL, 0);
    assert_true(ablation.asked == ablation.parts);
    neph_ablation_finish(&ablation);
}

static void test_a_part_that_is_not_there_is_refused(void **state)
{
    static const char *const unknown[] = {"overide"}, *const absent[] = {"upscale_dither"};
    struct neph_ablation ablation = {.preset = NULL};
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_ablation_plan("ours", unknown, 1, &ablation, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "overide"));
    assert_non_null(strstr(diag.hint, "override"));
    neph_ablation_finish(&ablation);
    assert_int_equal(neph_ablation_plan("ours", absent, 1, &ablation, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "upscale_dither=none"));
    neph_ablation_finish(&ablation);
}

/* --- values ----------------------------------------------------------------------------------- */

/* All cells count and are 1; a pixel costs 2 evaluations and 3 bytes; the device has no timestamps.
 */
static void make_study(struct neph_ablation *ablation)
{
    static const char *const names[SCENES] = {"one", "two", "three", "four"};
    static struct neph_flicker_study_params params;
    struct neph_flicker_study *study = &ablation->study;
    params = (struct neph_flicker_study_params){.presets = ablation->words,
                                                .preset_count = ablation->configuration_count,
                                                .scene_count = SCENES,
                                                .seed_count = SEEDS,
                                                .frame_count = 32,
                                                .steps = 8,
                                                .width_px = 16,
                                                .height_px = 9,
                                                .takes = {true, true},
                                                .brief = true};
    neph_assert_ok(neph_flicker_study_begin(&params, study, NULL), NULL);
    snprintf(study->device, sizeof(study->device), "nowhere");
    const int rows = SCENES * SEEDS * params.preset_count;
    for (int s = 0; s < SCENES; s++)
        study->scenes[s].name = names[s];
    for (int i = 0; i < rows; i++)
        study->costs[i] = (struct neph_study_cost){2.0, 3.0, NAN, NAN, NULL};
    for (int i = 0; i < rows * neph_study_metric_count(); i++)
        study->cells[i] = (struct neph_study_cell){.value = 1.0, .displays = {1.0}, .counts = true};
}

enum { ERROR, FLICKER, EDGE_FLICKER, FOUR_FRAME, HALF_LIFE, EVALUATIONS, TRAFFIC, GPU_MS };

static struct neph_study_cell *find_ablation_cell(const struct neph_ablation *ablation, int scene,
                                                  int preset, int seed, int measure)
{
    int metric = 0;
    while (strcmp(neph_study_metrics[metric].metric, neph_ablation_measures[measure].metric) != 0 ||
           strcmp(neph_study_metrics[metric].mask, neph_ablation_measures[measure].mask) != 0)
        metric++;
    return neph_study_cell_at(&ablation->study, scene, preset, seed, metric);
}

static void set(const struct neph_ablation *ablation, int scene, int preset, int measure,
                double value)
{
    for (int seed = 0; seed < SEEDS; seed++) {
        struct neph_study_cell *cell = find_ablation_cell(ablation, scene, preset, seed, measure);
        cell->value = cell->displays[0] = value * (seed ? 10.0 : 0.1); /* their mean is `value` */
    }
}

static const char *const override_alone[] = {"override"};

static const struct neph_ablation_comparison *planned(struct neph_ablation *ablation)
{
    plan(ablation, override_alone, 1);
    make_study(ablation);
    return neph_ablation_find(ablation, neph_ablation_part_find("override"),
                              NEPH_ABLATION_IN_PRESET);
}

static void test_measures_are_metrics_of_a_flicker_study(void **state)
{
    struct neph_ablation ablation;
    planned(&ablation);
    assert_int_equal(neph_ablation_measure_count(), GPU_MS + 1);
    for (int m = 0; neph_ablation_measures[m].metric; m++)
        assert_non_null(find_ablation_cell(&ablation, 0, 0, 0, m));
    assert_true(neph_ablation_has_measure(&ablation, HALF_LIFE));
    struct neph_flicker_study_params params = *ablation.study.params;
    params.takes[NEPH_STUDY_STEP] = false;
    ablation.study.params = &params;
    assert_false(neph_ablation_has_measure(&ablation, HALF_LIFE));
    assert_true(neph_ablation_has_measure(&ablation, TRAFFIC));
    neph_ablation_finish(&ablation);
}

/* Without the override the error is 0.1 .. 0.4 decades larger. The mean effect is -0.25, the
 * standard deviation sqrt(0.05 / 3), t = -0.25 / (that / 2) with three degrees of freedom. Three
 * values are judged, as half-life and bytes change as well. */
static void test_an_effect_is_students_interval_over_scenes(void **state)
{
    struct neph_ablation ablation;
    const struct neph_ablation_comparison *of = planned(&ablation);
    for (int s = 0; s < SCENES; s++) {
        set(&ablation, s, of->with, ERROR, 1.0);
        set(&ablation, s, of->without, ERROR, pow(10.0, 0.1 * (s + 1)));
        set(&ablation, s, of->without, HALF_LIFE, s < 2 ? 10.0 : 0.1);
        for (int seed = 0; seed < SEEDS; seed++)
            neph_study_cost_at(&ablation.study, s, of->without, seed)->traffic_bytes = 0.3;
    }
    neph_assert_ok(neph_ablation_judge(&ablation, NULL), NULL);
    const struct neph_ablation_effect *error = &of->effects[ERROR];
    const double deviation = sqrt(0.05 / 3.0);
    const double half = neph_student_critical(0.05, 3.0) * deviation / 2.0;
    assert_int_equal(error->scene_count, 4);
    neph_assert_close(error->mean, -0.25, 1e-12, 0.0);
    neph_assert_close(error->low, -0.25 - half, 1e-9, 0.0);
    neph_assert_close(error->high, -0.25 + half, 1e-9, 0.0);
    neph_assert_close(error->p, neph_student_p(0.25 / (deviation / 2.0), 3.0), 1e-9, 0.0);
    assert_int_equal(error->better, 4);
    assert_int_equal(error->worse + error->alike, 0);
    assert_int_equal(error->best_scene, 3);
    assert_int_equal(error->worst_scene, -1);
    assert_int_equal(ablation.judged_count, 3);
    /* Holm: p of the bytes is 0, as all scenes agree, so two remain for the error. */
    neph_assert_close(error->p_holm, 2.0 * error->p, 1e-12, 0.0);
    assert_int_equal(error->verdict,
                     error->p_holm < 0.05 ? NEPH_ABLATION_BUYS : NEPH_ABLATION_MAY_BUY);
    const struct neph_ablation_effect *bytes = &of->effects[TRAFFIC];
    neph_assert_close(bytes->mean, 1.0, 1e-12, 0.0);
    assert_int_equal(bytes->verdict, NEPH_ABLATION_COSTS);
    assert_int_equal(of->effects[HALF_LIFE].verdict, NEPH_ABLATION_UNDECIDED);
    assert_int_equal(of->effects[HALF_LIFE].best_scene, 0);
    assert_int_equal(of->effects[HALF_LIFE].worst_scene, 2);
    assert_int_equal(of->effects[EVALUATIONS].verdict, NEPH_ABLATION_SAME);
    assert_int_equal(of->effects[GPU_MS].verdict, NEPH_ABLATION_NO_NUMBER);
    neph_ablation_finish(&ablation);
}

/* A change of 4 % is "nothing", 6 % is not; equal changes in all scenes are certain. */
static void test_little_is_nothing(void **state)
{
    struct neph_ablation ablation;
    const struct neph_ablation_comparison *of = planned(&ablation);
    for (int s = 0; s < SCENES; s++) {
        set(&ablation, s, of->with, ERROR, 1.04);
        set(&ablation, s, of->with, FLICKER, 1.06);
        set(&ablation, s, of->with, EDGE_FLICKER, s % 2 ? 1.02 : 1.0 / 1.02);
        set(&ablation, s, of->with, FOUR_FRAME, s ? 1.0 : 1.2);
    }
    neph_assert_ok(neph_ablation_judge(&ablation, NULL), NULL);
    assert_int_equal(of->effects[ERROR].verdict, NEPH_ABLATION_NOTHING);
    assert_int_equal(of->effects[FLICKER].verdict, NEPH_ABLATION_COSTS);
    assert_int_equal(of->effects[EDGE_FLICKER].verdict, NEPH_ABLATION_NOTHING);
    assert_int_equal(of->effects[FOUR_FRAME].verdict, NEPH_ABLATION_UNDECIDED);
    assert_int_equal(of->effects[FOUR_FRAME].alike, 3);
    neph_ablation_finish(&ablation);
}

/* A scene with a seed whose value does not count is left out; a single scene has no interval. */
static void test_scenes_without_a_number_are_left_out(void **state)
{
    struct neph_ablation ablation;
    const struct neph_ablation_comparison *of = planned(&ablation);
    for (int s = 0; s < SCENES; s++) {
        set(&ablation, s, of->with, ERROR, 0.5);
        find_ablation_cell(&ablation, s, of->without, 1, ERROR)->counts = s == 2;
        find_ablation_cell(&ablation, s, of->with, 0, FLICKER)->counts = false;
    }
    neph_assert_ok(neph_ablation_judge(&ablation, NULL), NULL);
    const struct neph_ablation_effect *error = &of->effects[ERROR];
    assert_int_equal(error->scene_count, 1);
    neph_assert_close(error->mean, log10(0.5), 1e-12, 0.0);
    assert_false(error->has_interval);
    assert_int_equal(error->verdict, NEPH_ABLATION_UNDECIDED);
    assert_int_equal(error->best_scene, 2);
    assert_true(isnan(error->scenes[0]));
    assert_int_equal(of->effects[FLICKER].verdict, NEPH_ABLATION_NO_NUMBER);
    assert_int_equal(ablation.judged_count, 1); /* the error of all parts at once */
    neph_ablation_finish(&ablation);
}

static void test_advice(void **state)
{
    static const struct {
        enum neph_ablation_verdict verdicts[3];
        enum neph_ablation_advice advice;
    } cases[] = {
        {{NEPH_ABLATION_BUYS, NEPH_ABLATION_COSTS, NEPH_ABLATION_UNDECIDED}, NEPH_ABLATION_KEEP},
        {{NEPH_ABLATION_COSTS, NEPH_ABLATION_MAY_BUY, NEPH_ABLATION_SAME}, NEPH_ABLATION_PERHAPS},
        {{NEPH_ABLATION_COSTS, NEPH_ABLATION_UNDECIDED}, NEPH_ABLATION_UNCERTAIN},
        {{NEPH_ABLATION_MAY_COST, NEPH_ABLATION_NOTHING}, NEPH_ABLATION_LEAVE_OUT},
        {{NEPH_ABLATION_NOTHING, NEPH_ABLATION_SAME}, NEPH_ABLATION_LITTLE},
        {{NEPH_ABLATION_SAME, NEPH_ABLATION_SAME}, NEPH_ABLATION_IDLE},
        {{NEPH_ABLATION_NO_NUMBER}, NEPH_ABLATION_UNMEASURED},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_ablation_comparison of = {.part = 0};
        for (int m = 0; m < 3; m++)
            of.effects[m].verdict = cases[i].verdicts[m];
        of.effects[GPU_MS].verdict = NEPH_ABLATION_BUYS; /* a time: without influence */
        assert_int_equal(neph_ablation_advise(&of), cases[i].advice);
    }
}

static void test_changes_in_words(void **state)
{
    static const struct {
        double ratio;
        const char *text;
    } cases[] = {{1.0, "0 %"},      {0.88, "-12 %"},    {1.05, "+5.0 %"},
                 {1.997, "+100 %"}, {16.0, "x16"},      {0.0005, "<-99 %"},
                 {1e6, ">x100"},    {1.0001, "+0.0 %"}, {0.0625, "-94 %"}};
    char text[NEPH_ABLATION_CHANGE_SIZE];
    for (size_t i = 0; i < COUNT(cases); i++) {
        neph_ablation_change(log10(cases[i].ratio), text);
        assert_string_equal(text, cases[i].text);
    }
}

/* ---- output ---------------------------------------------------------------------------------- */

static void list_parts(const void *ablation, FILE *out)
{
    neph_ablation_list(ablation, out);
}

static void test_output_has_every_number(void **state)
{
    struct neph_ablation ablation;
    struct neph_publication publication;
    char *list = NULL;
    const struct neph_ablation_comparison *of = planned(&ablation);
    for (int s = 0; s < SCENES; s++)
        set(&ablation, s, of->without, ERROR, s == 1 ? 2.0 : 1.9);
    for (int s = 0; s < SCENES; s++)
        set(&ablation, s, of->without, FOUR_FRAME, 1000.0);
    ablation.study.scenes[3].left_out = "it is too deep";
    neph_assert_ok(neph_ablation_judge(&ablation, NULL), NULL);
    begin_published(&publication);
    neph_assert_ok(neph_ablation_publish(&ablation, &publication, NULL), NULL);
    const char *text = published_text(publication.text, &publication);
    assert_non_null(strstr(text, "Left out: four: it is too deep."));
    assert_non_null(strstr(text, "- override: lowers relative RMSE (-48 %), four-frame flicker at "
                                 "depth edges (<-99 %); most in two (relative RMSE -50 %).\n"));
    assert_non_null(strstr(text, "| override | **-48 %** | = | = | **<-99 %** | = | = | = | - |"));
    assert_non_null(strstr(text, "not in this preset: upscale_dither"));
    const char *csv = published_text(publication.csv, &publication);
    /* three comparisons of seven measures in four scenes and their mean; there are no times */
    assert_int_equal(count_parts(csv, "\r\n"), 1 + 3 * 7 * (SCENES + 1));
    const char *svg = published_text(publication.chart, &publication);
    /* One row, with bars of two measures in the preset; no bar where nothing changes. */
    assert_int_equal(count_parts(svg, ">override</text>"), 1);
    assert_int_equal(count_parts(svg, "height=\"7\" fill=\"#888\""), 1 + 2); /* the key, two bars */
    assert_int_equal(count_parts(svg, ">&#60;-99 %</text>"), 1); /* beyond the axis: labelled */
    neph_assert_ok(neph_write_to_text(list_parts, &ablation, &list, NULL), NULL);
    assert_int_equal(count_parts(list, "without it: "), neph_ablation_part_count());
    assert_int_equal(count_parts(list, "not in this preset"), 7);
    assert_int_equal(json_array_size(json_object_get(publication.json, "parts")),
                     neph_ablation_part_count());
    neph_publication_finish(&publication);
    free(list);
    neph_ablation_finish(&ablation);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * An attribution from synthetic numbers: seeds, scenes, reasons.
 */
#include "tests/neph_test.h"

#include "harness/study/attribution_study.h"
#include "metrics/significance.h"

/* Two scenes with flicker, one that a preset cannot render, one with a failed sequence, one without
 * flicker. */
enum { FIRST, SECOND, LEFT_OUT, FAILED, STILL, SCENES, SEEDS = 2 };

/* Squared thresholds of each part; nothing interacts. */
static const double sizes[SCENES][NEPH_PARTS] = {
    [FIRST] = {10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 28.0, 2.0},
    [SECOND] = {16.0, -6.0, 0.0, 0.0, 0.0, 2.0, 8.0, 0.0},
};

struct fixture {
    struct neph_arena arena;
    struct neph_attribution_plan plan;
    struct neph_flicker_study_params params;
    struct neph_flicker_study study;
    struct neph_attribution_study attribution;
};

/* The flicker seen with these parts real: the squares of both seeds are 0.5 and 1.5 of the mean. */
static double synthetic_seen(int scene, int seed, neph_part_set real)
{
    double squared = 0.0;
    for (int i = 0; i < NEPH_PARTS; i++)
        squared += (real >> i & 1U) != 0 ? sizes[scene][i] : 0.0;
    return sqrt(squared * (0.5 + seed));
}

static void fill_study(struct fixture *fixture)
{
    static const char *const names[SCENES] = {"first", "second", "left_out", "failed", "still"};
    struct neph_flicker_study *study = &fixture->study;
    const neph_part_set blur = 1U << NEPH_PART_BLUR, aliasing = 1U << NEPH_PART_ALIASING;
    for (int scene = 0; scene < SCENES; scene++) {
        study->scenes[scene].name = names[scene];
        for (int i = 0; i < fixture->plan.count; i++)
            for (int seed = 0; seed < SEEDS; seed++) {
                struct neph_study_cell *cell = neph_study_cell_at(study, scene, i, seed,
                                                                  neph_study_find_headline());
                const neph_part_set real = fixture->plan.states[i];
                cell->value = synthetic_seen(scene, seed, real | blur | aliasing);
                cell->ideals[NEPH_IDEAL_SEQUENCE] = synthetic_seen(scene, seed, real);
                cell->ideals[NEPH_IDEAL_BLURRED] = synthetic_seen(scene, seed, real | aliasing);
                cell->ideals[NEPH_IDEAL_ALIASED] = synthetic_seen(scene, seed, real | blur);
                cell->counts = true;
                neph_study_cost_at(study, scene, i, seed)->blur_px = 0.5 + 0.2 * seed;
            }
    }
    struct neph_study_cell *failed = neph_study_cell_at(study, FAILED, 20, 1,
                                                        neph_study_find_headline());
    failed->counts = false;
    snprintf(failed->because, sizeof(failed->because), "the device was lost");
    study->scenes[LEFT_OUT].left_out = "it has no sun";
}

static void begin(struct fixture *fixture)
{
    static const char *const scenes[SCENES] = {"a", "b", "c", "d", "e"};
    *fixture = (struct fixture){.arena = {.last = NULL}};
    neph_assert_ok(neph_attribution_plan_make("ours", 8, &fixture->arena, &fixture->plan, NULL),
                   NULL);
    fixture->params = (struct neph_flicker_study_params){.presets = fixture->plan.words,
                                                         .preset_count = fixture->plan.count,
                                                         .scenes = scenes,
                                                         .scene_count = SCENES,
                                                         .seed_count = SEEDS};
    neph_assert_ok(neph_flicker_study_begin(&fixture->params, &fixture->study, NULL), NULL);
    fill_study(fixture);
    neph_assert_ok(neph_attribution_judge(&fixture->plan, &fixture->study, &fixture->arena,
                                          &fixture->attribution, NULL),
                   NULL);
}

static void end(struct fixture *fixture)
{
    neph_flicker_study_finish(&fixture->study);
    neph_arena_finish(&fixture->arena);
}

static void test_squares_of_seeds_are_averaged(void **state)
{
    struct fixture fixture;
    begin(&fixture);
    for (int scene = FIRST; scene <= SECOND; scene++) {
        const struct neph_attribution_values *values = &fixture.attribution.scenes[scene].values;
        assert_null(fixture.attribution.scenes[scene].why);
        neph_assert_close(values->all, scene == FIRST ? 40.0 : 20.0, 1e-12, 0.0);
        neph_assert_close(fixture.attribution.scenes[scene].blur_px, 0.6, 1e-12, 0.0);
        for (int i = 0; i < NEPH_PARTS; i++)
            neph_assert_close(values->parts[i].share, sizes[scene][i], 0.0, 1e-11);
    }
    end(&fixture);
}

static void test_scenes_without_values_say_why(void **state)
{
    struct fixture fixture;
    begin(&fixture);
    const struct neph_attribution_scene *scenes = fixture.attribution.scenes;
    assert_string_equal(scenes[LEFT_OUT].why, "it has no sun");
    assert_string_equal(scenes[FAILED].why, "the device was lost");
    assert_string_equal(scenes[STILL].why, "no flicker is seen");
    assert_int_equal(fixture.attribution.scene_count, 2);
    assert_int_equal(fixture.attribution.explained_count, 2);
    end(&fixture);
}

/* Percents 25 and 80, 70 and 40; the interval of two values is their mean +- t(1) times half of
 * their difference. */
static void test_percents_over_scenes(void **state)
{
    struct fixture fixture;
    begin(&fixture);
    const struct neph_attribution_row *rows = fixture.attribution.rows,
                                      *rays = &rows[NEPH_PART_RAYS], *blur = &rows[NEPH_PART_BLUR];
    const double critical = neph_student_critical(0.05, 1.0);
    neph_assert_close(rays->percent, 52.5, 1e-12, 0.0);
    neph_assert_close(rays->low, 52.5 - critical * 27.5, 1e-9, 0.0);
    neph_assert_close(rays->high, 52.5 + critical * 27.5, 1e-9, 0.0);
    assert_true(rays->has_interval);
    neph_assert_close(blur->percent, 55.0, 1e-12, 0.0);
    neph_assert_close(rows[NEPH_PART_ALIASING].percent, 2.5, 1e-11, 0.0);
    neph_assert_close(rows[NEPH_PART_REPROJECTION].percent, -15.0, 1e-11, 0.0);
    assert_int_equal(rays->worst_scene, SECOND);
    assert_int_equal(blur->worst_scene, FIRST);
    assert_int_equal(rows[NEPH_PART_REPROJECTION].worst_scene, -1);
    /* ideal blur: from 40 to 12 and from 20 to 12 */
    neph_assert_close(blur->falls, 50.0 * (2.0 - sqrt(0.3) - sqrt(0.6)), 1e-12, 0.0);
    const int *order = fixture.attribution.order;
    assert_int_equal(order[0], NEPH_PART_BLUR);
    assert_int_equal(order[1], NEPH_PART_RAYS);
    assert_int_equal(order[2], NEPH_PART_UPSCALE);
    assert_int_equal(order[NEPH_PARTS - 1], NEPH_PART_REPROJECTION);
    end(&fixture);
}

/* Bars to the left and to the right of 0; the frame of the chart does not depend on them. */
static void test_the_chart_has_negative_shares(void **state)
{
    struct fixture fixture;
    char *text = NULL;
    size_t size = 0;
    begin(&fixture);
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    neph_attribution_plot(&fixture.attribution, out);
    assert_int_equal(fclose(out), 0);
    assert_non_null(strstr(text, ">-30</text>")); /* reprojection of `second`, percent */
    assert_non_null(strstr(text, "width=\"840\""));
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, "failed"));
    for (int i = 0; i < NEPH_PARTS; i++) /* the key */
        assert_non_null(strstr(text, neph_attribution_parts[i].name));
    free(text);
    end(&fixture);
}

#include "tests/main.h"

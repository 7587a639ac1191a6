/* SPDX-License-Identifier: MIT
 *
 * Exponents against closed forms, verdicts on them, scenes with given voxel counts, and the
 * stability of fronts within their intervals.
 */
#include "tests/neph_test.h"

#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/sweep/candidates.h"
#include "harness/sweep/front.h"
#include "harness/sweep/repeat.h"
#include "harness/sweep/scaled.h"
#include "harness/sweep/scaling.h"
#include "harness/sweep/stability.h"
#include "scenes/media.h"
#include "scenes/rescatter.h"
#include "scenes/variant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- exponents ------------------------------------------------------------------------------ */

static void test_a_power_law_has_its_exponent(void **state)
{
    const double x[] = {16, 2, 4, 8}, y[] = {3 * 64, 3 * 2.8284271247461903, 3 * 8, 3 * 22.627417};
    const struct neph_exponent exact = neph_exponent_fit(x, y, 4);
    assert_int_equal(exact.count, 4);
    assert_true(fabs(exact.value - 1.5) < 1e-8);
    assert_true(exact.high - exact.low < 1e-6 && exact.low <= exact.value);
}

/* Points (0, 0), (1, 1), (2, 1) in logarithms: slope 1/2, squares of the residuals sum to 1/6, and
 * Student's t for one degree of freedom is 12.7062. A fourth point has no logarithm. */
static void test_scatter_makes_an_interval(void **state)
{
    const double x[] = {1, M_E, exp(2.0), 5}, y[] = {1, M_E, M_E, 0};
    const struct neph_exponent found = neph_exponent_fit(x, y, 4);
    assert_int_equal(found.count, 3);
    assert_true(fabs(found.value - 0.5) < 1e-12);
    assert_true(fabs(found.high - found.value - 12.706204736 * sqrt(1.0 / 12.0)) < 1e-6);
    assert_true(fabs(found.value - found.low - (found.high - found.value)) < 1e-12);
    assert_true(isnan(neph_exponent_fit(x, y, 2).value));
    const double one[] = {2, 2, 2};
    assert_true(isnan(neph_exponent_fit(one, y, 3).value));
}

static void test_verdicts_on_exponents(void **state)
{
    static const struct {
        struct neph_exponent exponent;
        enum neph_exponent_verdict verdict;
    } cases[] = {
        {{1.0, 1.0, 1.0, 5}, NEPH_EXPONENT_EXPECTED},
        {{0.95, 0.91, 0.99, 5}, NEPH_EXPONENT_EXPECTED},
        {{1.3, 1.2, 1.4, 5}, NEPH_EXPONENT_OTHER},
        {{0.0, 0.0, 0.0, 5}, NEPH_EXPONENT_OTHER},
        {{1.0, 0.5, 1.5, 5}, NEPH_EXPONENT_UNCERTAIN},
        {{NAN, NAN, NAN, 1}, NEPH_EXPONENT_NONE},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        assert_int_equal(
            neph_exponent_judge(&cases[i].exponent, (struct neph_exponent_range){1, 1}),
            cases[i].verdict);
}

static void test_lines_are_judged(void **state)
{
    struct neph_scaling scaling = {.line_count = 2};
    for (int i = 0; i < 2; i++) {
        struct neph_scaling_line *line = &scaling.lines[i];
        line->axis = i ? NEPH_SCALING_VOXELS : NEPH_SCALING_STEPS;
        line->count = 4;
        for (int k = 0; k < 4; k++)
            line->points[k] = (struct neph_scaling_point){
                pow(2.0, k), 100.0 * pow(2.0, k), {1e-3 + 1e-5 * pow(2.0, k), NAN, NAN}};
    }
    neph_scaling_judge(&scaling);
    assert_int_equal(scaling.lines[0].work_verdict, NEPH_EXPONENT_EXPECTED);
    assert_int_equal(scaling.lines[0].time_verdict, NEPH_EXPONENT_EXPECTED);
    assert_int_equal(scaling.lines[1].work_verdict, NEPH_EXPONENT_OTHER);
    for (int axis = 0; axis < NEPH_SCALING_AXES; axis++)
        assert_true(neph_scaling_value_count(&neph_scaling_axes[axis]) >= 4 &&
                    neph_scaling_axes[axis].work.low <= neph_scaling_axes[axis].work.high);
}

/* --- scenes --------------------------------------------------------------------------------- */

static struct neph_scene *load(const char *name)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_data_load_scene(name, &scene, &diag), &diag);
    return scene;
}

static void test_a_scene_of_so_many_voxels(void **state)
{
    struct neph_scene *blob = load("gaussian_blob"), *fog = load("height_fog_level"), *made = NULL;
    struct neph_diag diag = {.line = 0};
    double coarse = 0.0, fine = 0.0, none = 0.0;
    for (int i = 0; i < 2; i++) {
        neph_assert_ok(neph_scaled_make(blob, i ? 16 : 8, &made, i ? &fine : &coarse, &diag),
                       &diag);
        assert_int_equal(made->media[0].kind, NEPH_MEDIUM_GRID);
        assert_string_not_equal(made->hash, blob->hash);
        neph_scaled_destroy(made);
    }
    assert_true(fabs(coarse - 8.0 * 8.0 * 8.0) < 1.0 && fabs(fine / coarse - 8.0) < 0.5);
    assert_int_equal(neph_scaled_make(fog, 8, &made, &none, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "no voxels"));
    neph_scene_destroy(fog);
    neph_scene_destroy(blob);
}

static const struct neph_candidate_lighting *light_named(const char *name)
{
    const struct neph_candidate_lighting *light = neph_candidate_lightings;
    while (strcmp(light->name, name) != 0)
        light++;
    return light;
}

/* Parts that a static camera does not need, and parts that wind needs. */
static void test_parts_for_motion(void **state)
{
    static const struct {
        const char *scene, *without;
    } cases[] = {
        {"gaussian_blob", "wind=off cut_reset=off reject_depth=0 taa_motion=centre"},
        {"wind_cloud", "cut_reset=off reject_depth=0"},
        {"camera_pan", "wind=off"},
        {"box_crosses", "wind=off"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_scene *scene = load(cases[i].scene);
        char text[NEPH_CANDIDATE_SETTINGS_SIZE];
        neph_candidate_settings(scene, light_named("scattered once"), true, false, text);
        assert_string_equal(text, cases[i].without);
        neph_scene_destroy(scene);
    }
}

/* Froxels where a medium is near, a shadow map where clouds cast shadows, each for the lighting
 * that supports it. The list of candidates contains settings with these parts where a scene needs
 * any. */
static void test_parts_of_the_air(void **state)
{
    static const struct {
        const char *scene, *light, *with;
        int rungs;
    } cases[] = {
        {"gaussian_blob", "scattered once", "froxels=on", 2},
        {"cloud_below", "octaves", "lighting=octaves cloud_shadow=map", 6},
        {"grid_cloud_multiple", "octaves", "lighting=octaves", 0},
        {"wind_cloud", "scattered once", "froxels=on cloud_shadow=map", 2},
        {"froxel_seam", "scattered once", "froxels=on", 2},
        {"froxel_seam", "no scattering", "", 2},
        {"cloud_shadow", "scattered once", "cloud_shadow=map", 2},
        {"cloud_gaps", "scattered once", "cloud_shadow=map", 2},
        {"slab_multiple_thin", "octaves", "lighting=octaves froxels=on", 4},
        {"slab_multiple_thin", "fitted octaves", "lighting=octaves_fitted", 4},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_scene *scene = load(cases[i].scene);
        struct neph_sweep_plan plan;
        int rungs = 0;
        char text[NEPH_CANDIDATE_SETTINGS_SIZE];
        neph_candidate_settings(scene, light_named(cases[i].light), false, true, text);
        print_message("%s, %s: '%s'\n", cases[i].scene, cases[i].light, text);
        assert_string_equal(text, cases[i].with);
        neph_assert_ok(neph_candidate_plan(scene, false, 64, 36, &plan, NULL), NULL);
        for (int s = 0; s < plan.series_count; s++)
            rungs += strstr(plan.series[s].name, "+air, ") != NULL;
        assert_int_equal(rungs, cases[i].rungs);
        neph_sweep_plan_finish(&plan);
        neph_scene_destroy(scene);
    }
}

/* Engines for one kind of scene are candidates where the scene is of this kind. */
static void test_the_ladder_has_engines_of_one_kind(void **state)
{
    static const struct {
        const char *scene, *engines;
    } cases[] = {{"gaussian_blob", ""},
                 {"height_fog_level", ""},
                 {"fog_look_evening", "fog_look "},
                 {"sky_earth", "sky "}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_scene *scene = load(cases[i].scene);
        struct neph_sweep_plan plan;
        char found[64] = "";
        neph_assert_ok(neph_candidate_plan(scene, false, 64, 36, &plan, NULL), NULL);
        for (int s = 0; s < plan.series_count; s++)
            for (int n = 0; neph_candidate_special_engines[n]; n++)
                if (strcmp(plan.series[s].engine, neph_candidate_special_engines[n]) == 0)
                    strcat(strcat(found, plan.series[s].name), " ");
        assert_string_equal(found, cases[i].engines);
        neph_sweep_plan_finish(&plan);
        neph_scene_destroy(scene);
    }
}

/* An external program reads the scene's file. It can render variants that differ from the file only
 * in sun and camera, as the job passes both. */
static void test_a_program_gets_variants_of_its_file(void **state)
{
    struct neph_scene *scene = load("gaussian_blob"), *step = NULL, *other = NULL, *both = NULL;
    struct neph_diag diag = {.line = 0};
    const struct neph_variant variant = {NEPH_VARIANT_SUN_STEP, 4, 8};
    const struct neph_engine *command = neph_engine_find("command");
    char why[256] = "";
    neph_assert_ok(neph_scene_variant(scene, &variant, &step, &diag), &diag);
    neph_assert_ok(neph_scene_rescatter(scene, NEPH_SCATTERING_NONE, &other, &diag), &diag);
    neph_assert_ok(neph_scene_variant(other, &variant, &both, &diag), &diag);
    assert_true(command->can_render(scene, NULL, why, sizeof(why)));
    assert_true(command->can_render(step, NULL, why, sizeof(why)));
    assert_string_equal(why, "");
    assert_false(command->can_render(other, NULL, why, sizeof(why)));
    assert_false(command->can_render(both, NULL, why, sizeof(why)));
    assert_non_null(strstr(why, "reads the file"));
    neph_scene_destroy(both);
    neph_scene_destroy(other);
    neph_scene_destroy(step);
    neph_scene_destroy(scene);
}

/* `neph pick` includes the user's renderer if there is one. */
static void test_the_ladder_has_a_guest(void **state)
{
    char path[] = "/tmp/neph_test_scaling_XXXXXX";
    static const char program[] = "#!/bin/sh\necho a renderer 1\n";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, program, strlen(program)), strlen(program));
    assert_int_equal(fchmod(fd, 0700), 0);
    close(fd);
    struct neph_scene *scene = load("gaussian_blob");
    for (int with = 0; with < 2; with++) {
        struct neph_sweep_plan plan;
        struct neph_diag diag = {.line = 0};
        if (with)
            setenv("NEPH_COMMAND", path, 1);
        else
            unsetenv("NEPH_COMMAND");
        neph_assert_ok(neph_candidate_plan(scene, false, 64, 36, &plan, &diag), &diag);
        assert_int_equal(strcmp(plan.series[plan.series_count - 1].engine, "command") == 0, with);
        neph_sweep_plan_finish(&plan);
    }
    unsetenv("NEPH_COMMAND");
    unlink(path);
    neph_scene_destroy(scene);
}

/* --- fronts --------------------------------------------------------------------------------- */

enum { SWEEPS = 2, POINTS = 3 };

/* Three points by cost and error; the second is worse than the first by the factor `gap`. */
static void make_sweep(const struct neph_sweep_series *series, double gap, double half,
                       struct neph_sweep_point points[POINTS], struct neph_sweep *sweep)
{
    const double costs[] = {1.0, 2.0, 4.0}, errors[] = {0.1, 0.1 * gap, 0.02};
    for (int i = 0; i < POINTS; i++) {
        points[i] = (struct neph_sweep_point){
            .series = series, .evaluations = costs[i], .time = {NAN, NAN, NAN}};
        for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
            points[i].numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
        points[i].numbers[NEPH_SWEEP_ERROR] = (struct neph_sweep_value){
            errors[i], errors[i] * (1.0 - half), errors[i] * (1.0 + half)};
        points[i].on_front[NEPH_SWEEP_ERROR] = i != 1 || gap < 1.0;
    }
    *sweep = (struct neph_sweep){.points = points, .point_count = POINTS};
}

static enum neph_stability_outcome outcome(const struct neph_sweep *sweeps, int point)
{
    return neph_stability_judge(sweeps, SWEEPS, point, NEPH_SWEEP_COST_WORK, NEPH_SWEEP_ERROR);
}

static void test_fronts_hold_up_to_intervals(void **state)
{
    const struct neph_sweep_series series = {.name = (char[]){"a"}};
    struct neph_sweep_point points[SWEEPS][POINTS];
    struct neph_sweep sweeps[SWEEPS];
    make_sweep(&series, 0.95, 0.1, points[0], &sweeps[0]);
    make_sweep(&series, 1.05, 0.1, points[1], &sweeps[1]); /* the intervals of both overlap */
    assert_int_equal(outcome(sweeps, 0), NEPH_STABILITY_ON);
    assert_int_equal(outcome(sweeps, 1), NEPH_STABILITY_WITHIN);
    assert_int_equal(outcome(sweeps, 2), NEPH_STABILITY_ON);
    make_sweep(&series, 1.5, 0.1, points[1], &sweeps[1]); /* now they are disjoint */
    assert_int_equal(outcome(sweeps, 1), NEPH_STABILITY_MOVED);
    make_sweep(&series, 1.5, 0.1, points[0], &sweeps[0]);
    assert_int_equal(outcome(sweeps, 1), NEPH_STABILITY_OFF);
    points[1][1].evaluations = NAN;
    assert_int_equal(outcome(sweeps, 1), NEPH_STABILITY_ABSENT);
    /* The second point is beaten: an error 1.5 times as large at twice the cost. A reduction of
     * both by a third would put it on the front. */
    make_sweep(&series, 1.5, 0.1, points[1], &sweeps[1]);
    assert_true(fabs(neph_stability_front_distance(sweeps, SWEEPS, 1, NEPH_SWEEP_COST_WORK,
                                                   NEPH_SWEEP_ERROR) -
                     0.5) < 1e-12);
    assert_true(neph_stability_front_distance(sweeps, SWEEPS, 2, NEPH_SWEEP_COST_WORK,
                                              NEPH_SWEEP_ERROR) == 0.0);
    /* A point beats neither itself nor an equal one. */
    assert_false(neph_stability_dominates(&points[0][0], &points[0][0], NEPH_SWEEP_COST_WORK,
                                          NEPH_SWEEP_ERROR));
}

/* --- seeds ---------------------------------------------------------------------------------- */

/* Nearly normal, variance 1: the sum of twelve uniform random numbers. */
static double normal(uint64_t *seed)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += neph_test_uniform(seed, 0.0, 1.0);
    return sum;
}

/* Three seeds of a value that has no interval: 95 % of the computed intervals contain the truth. */
static void test_intervals_of_seeds_cover_the_truth(void **state)
{
    enum { TRIALS = 2000, SEEDS = 3 };
    uint64_t seed = 20261125;
    int held = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        struct neph_sweep_value values[SEEDS];
        for (int i = 0; i < SEEDS; i++)
            values[i] = (struct neph_sweep_value){1.0 + 0.1 * normal(&seed), NAN, NAN};
        const struct neph_sweep_value mean = neph_sweep_average_seeds(values, SEEDS);
        held += mean.low <= 1.0 && 1.0 <= mean.high;
    }
    /* 95 %, plus or minus four standard deviations of the count */
    assert_true(abs(held - 95 * TRIALS / 100) < 4 * sqrt(0.95 * 0.05 * TRIALS));
    /* One seed has the interval over its pixels. Several seeds have both intervals, added as
     * squares. */
    const struct neph_sweep_value one = {2.0, 1.7, 2.4}, same[] = {one, one, one};
    const struct neph_sweep_value alone = neph_sweep_average_seeds(&one, 1),
                                  three = neph_sweep_average_seeds(same, 3);
    assert_true(alone.low == 1.7 && alone.high == 2.4);
    assert_true(three.value == 2.0 && fabs(three.low - 1.7) < 1e-12 &&
                fabs(three.high - 2.4) < 1e-12);
    /* Student's t for two degrees of freedom is 4.302653; the mean's error is 0.1 / sqrt(3). */
    const struct neph_sweep_value apart[] = {{1.9, 1.6, 2.2}, {2.0, 1.7, 2.3}, {2.1, 1.8, 2.4}};
    const struct neph_sweep_value both = neph_sweep_average_seeds(apart, 3);
    assert_true(fabs(both.high - 2.0 - hypot(0.3, 4.302653 * 0.1 / sqrt(3.0))) < 1e-6);
    assert_true(isnan(
        neph_sweep_average_seeds((struct neph_sweep_value[]){one, {NAN, NAN, NAN}}, 2).value));
}

/* Sweeps with consecutive seeds have no seed in common, neither of points nor of the truth. */
static void test_sweeps_share_no_seed(void **state)
{
    enum { BASES = 16, REPEATS = 99 + 2 };
    uint64_t all[BASES * REPEATS];
    int count = 0;
    for (int base = 0; base < BASES; base++)
        for (int i = 0; i < REPEATS; i++)
            all[count++] = neph_sweep_seed((uint64_t)(1000000 - base),
                                           i < 99 ? i : NEPH_SWEEP_TRUTH_REPEAT + i - 99);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            assert_true(all[i] != all[k]);
}

enum { PLANTED_SWEEPS = 3, PLANTED_POINTS = 8, PLANTED_SEEDS = 3 };

/* Fronts of sweeps whose values are planned ones times random noise of each seed. In the sweep
 * `gone` the third point comes from a different engine. */
static int moved_points(uint64_t *seed, double noise, int gone)
{
    struct neph_sweep_series series = {.name = (char[]){"a"}};
    struct neph_sweep_point points[PLANTED_SWEEPS][PLANTED_POINTS];
    struct neph_sweep sweeps[PLANTED_SWEEPS];
    int moved = 0;
    for (int s = 0; s < PLANTED_SWEEPS; s++) {
        struct neph_front_point front[PLANTED_POINTS];
        for (int i = 0; i < PLANTED_POINTS; i++) {
            struct neph_sweep_value values[PLANTED_SEEDS];
            const double plan = (s == gone && i == 2 ? 3.0 : 1.0) / (1.0 + i / 2);
            for (int k = 0; k < PLANTED_SEEDS; k++)
                values[k] = (struct neph_sweep_value){plan * (1.0 + noise * normal(seed)), NAN,
                                                      NAN};
            points[s][i] = (struct neph_sweep_point){
                .series = &series, .evaluations = 1.0 + i, .time = {NAN, NAN, NAN}};
            points[s][i].numbers[NEPH_SWEEP_ERROR] = neph_sweep_average_seeds(values,
                                                                              PLANTED_SEEDS);
            front[i].values[0] = points[s][i].evaluations;
            front[i].values[1] = points[s][i].numbers[NEPH_SWEEP_ERROR].value;
        }
        neph_front_find(front, PLANTED_POINTS, 2);
        for (int i = 0; i < PLANTED_POINTS; i++)
            points[s][i].on_front[NEPH_SWEEP_ERROR] = front[i].on_front;
        sweeps[s] = (struct neph_sweep){.points = points[s], .point_count = PLANTED_POINTS};
    }
    for (int i = 0; i < PLANTED_POINTS; i++)
        moved += neph_stability_judge(sweeps, PLANTED_SWEEPS, i, NEPH_SWEEP_COST_WORK,
                                      NEPH_SWEEP_ERROR) == NEPH_STABILITY_MOVED;
    return moved;
}

/* In each pair the second point costs more at an equal value. Which of the two is on the front
 * depends on noise; no point has moved. A point that comes from a different engine in one sweep has
 * moved. */
static void test_planted_fronts(void **state)
{
    enum { TRIALS = 300 };
    uint64_t seed = 20261126;
    int stable = 0, unstable = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        stable += moved_points(&seed, 0.02, -1) > 0;
        unstable += moved_points(&seed, 0.02, trial % PLANTED_SWEEPS) > 0;
    }
    assert_true(stable < TRIALS / 10);
    assert_true(unstable > 9 * TRIALS / 10);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Summary lines, and those of a sweep with known values.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "base/written.h"
#include "harness/document/answer.h"
#include "harness/engines/engines.h"
#include "harness/sweep/answer.h"
#include "harness/sweep/finest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct printed {
    const struct neph_answer *answer;
    const struct neph_answer_rest *rest;
    bool is_brief;
};

static void print(const void *context, FILE *out)
{
    const struct printed *printed = context;
    neph_answer_print(printed->answer, printed->rest, printed->is_brief, out);
}

/* For free(). */
static char *print_answer_text(const struct neph_answer *answer,
                               const struct neph_answer_rest *rest, bool is_brief)
{
    const struct printed printed = {answer, rest, is_brief};
    char *text = NULL;
    assert_int_equal(neph_write_to_text(print, &printed, &text, NULL), NEPH_OK);
    return text;
}

static void test_an_answer_has_ten_lines_at_most(void **state)
{
    static const char *const files[] = {"no_such_file", "document", "compare", NULL};
    const struct neph_answer_rest rest = {"--all or --json", NEPH_SOURCE_DIR "/harness", files};
    struct neph_answer answer = {.count = 0};
    for (int i = 0; i < 20; i++)
        neph_answer_add(&answer, "line %d\x1b[2J", i);
    char *text = print_answer_text(&answer, &rest, false);
    assert_string_equal(text,
                        "line 0\\x1b[2J\nline 1\\x1b[2J\nline 2\\x1b[2J\nline 3\\x1b[2J\n"
                        "line 4\\x1b[2J\nline 5\\x1b[2J\nline 6\\x1b[2J\nline 7\\x1b[2J\n"
                        "line 8\\x1b[2J\nall numbers: --all or --json; files in " NEPH_SOURCE_DIR
                        "/harness: document, compare\n");
    free(text);
    text = print_answer_text(&answer, &rest, true);
    assert_string_equal(text, "line 0\\x1b[2J\n");
    free(text);
    neph_answer_finish(&answer);
}

static void test_words_of_differences(void **state)
{
    char text[NEPH_ANSWER_INTERVAL_SIZE];
    assert_string_equal(neph_answer_difference_word(-2.0, -1.0), "better");
    assert_string_equal(neph_answer_difference_word(1.0, 2.0), "worse");
    assert_string_equal(neph_answer_difference_word(-1.0, 2.0), "not told apart");
    assert_string_equal(neph_answer_difference_word(-1.0, 0.0), "not told apart");
    assert_string_equal(neph_answer_difference_word(NAN, NAN), "not told apart");
    assert_string_equal(neph_answer_difference_word(0.0, 0.0), "equal");
    assert_string_equal(neph_answer_interval(10.1, 14.9, text), " (10.1 to 14.9)");
    assert_string_equal(neph_answer_interval(NAN, 14.9, text), "");
}

/* ---- sweeps ---------------------------------------------------------------------------------- */

static const struct neph_value {
    int series;
    const char *label;
    double error, high, ms, to_finest;
} values[] = {
    {0, "steps=8", 0.20, 0.21, 1.0, 0.03},     {0, "steps=16", 0.18, 0.19, 2.0, 0.008},
    {0, "steps=32", 0.17, 0.18, 4.0, 0.012},   {0, "steps=64", 0.17, 0.18, 8.0, 0.002},
    {0, "steps=128", 0.17, 0.18, 16.0, NAN},   {1, "samples=16", 0.02, 0.021, 30.0, NAN},
    {1, "samples=64", 0.009, 0.011, 90., NAN},
};
enum { POINTS = sizeof(values) / sizeof(values[0]) };

struct made {
    struct neph_sweep_series series[2];
    struct neph_sweep_plan plan;
    struct neph_scene scene;
    struct neph_engine_info info;
    struct neph_sweep_point points[POINTS];
    struct neph_sweep sweep;
};

static void make(struct made *made)
{
    *made = (struct made){
        .series = {{.name = "march", .engine = "march", .varied = "steps"},
                   {.name = "tracer", .engine = "tracer", .varied = "samples"}},
        .plan = {.series = made->series, .series_count = 2, .width_px = 16, .height_px = 9},
        .sweep = {.plan = &made->plan,
                  .scene = &made->scene,
                  .points = made->points,
                  .point_count = POINTS,
                  .truth = "exact"},
    };
    for (int i = 0; i < POINTS; i++) {
        struct neph_sweep_point *point = &made->points[i];
        const struct neph_sweep_series *series = &made->series[values[i].series];
        *point = (struct neph_sweep_point){
            .series = series,
            .job = {.engine = neph_engine_find(series->engine), .info = &made->info},
            .frame_key = "key",
            .evaluations = NAN};
        for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
            point->numbers[n] = (struct neph_sweep_value){NAN, NAN, NAN};
        snprintf(point->label, sizeof(point->label), "%s", values[i].label);
        point->numbers[NEPH_SWEEP_ERROR] = (struct neph_sweep_value){
            values[i].error, values[i].error, values[i].high};
        point->to_finest = (struct neph_sweep_value){values[i].to_finest, values[i].to_finest,
                                                     values[i].to_finest};
        point->time = (struct neph_spread){1e-3 * values[i].ms, 0.9e-3 * values[i].ms,
                                           1.1e-3 * values[i].ms};
    }
}

static void check_verdict(const struct neph_sweep *sweep, double error, const char *expected)
{
    struct neph_answer answer = {.count = 0};
    neph_sweep_answer(sweep, error, &answer);
    assert_true(answer.count > 0);
    assert_string_equal(answer.lines[0], expected);
    neph_answer_finish(&answer);
}

static void test_the_cheapest_series_at_an_error(void **state)
{
    struct made made;
    make(&made);
    check_verdict(&made.sweep, 0.2,
                  "march: 8 steps for 20 % of error: off by 20 % (20 to 21), not told apart from "
                  "that error, 1 ms a frame, the cheapest of 2 series");
    check_verdict(&made.sweep, 0.19,
                  "march: 16 steps for 19 % of error: off by 18 % (18 to 19), 2 ms a frame, the "
                  "cheapest of 2 series");
    check_verdict(&made.sweep, 0.05,
                  "tracer: 16 samples for 5 % of error: off by 2 % (2 to 2.1), 30 ms a frame, the "
                  "cheapest of 2 series");
}

/* With all orders of scattering no number of steps is within the error. The answer names the number
 * of steps from which on the marcher is within the error of its own limit. */
static void test_steps_for_an_error_of_the_steps(void **state)
{
    struct made made;
    make(&made);
    const struct neph_sweep_point *finest = neph_sweep_finest(&made.sweep, &made.series[0]);
    assert_string_equal(finest->label, "steps=128");
    assert_null(neph_sweep_finest(&made.sweep, &made.series[1]));
    assert_string_equal(neph_sweep_converged(&made.sweep, &made.series[0], 0.01)->label,
                        "steps=64"); /* 32 steps have a larger error than 16 */
    assert_string_equal(neph_sweep_converged(&made.sweep, &made.series[0], 0.02)->label,
                        "steps=16");
    assert_null(neph_sweep_converged(&made.sweep, &made.series[0], 0.001));
    made.points[POINTS - 1].numbers[NEPH_SWEEP_ERROR].value = 0.0101;
    check_verdict(&made.sweep, 0.01,
                  "march: 64 steps for 1 % of error against its own 128 steps: 0.2 % (0.2 to 0.2), "
                  "8 ms a frame; its lighting model is 17 % (17 to 18) off the truth");
    check_verdict(&made.sweep, 0.001,
                  "no series is within 0.1 % of the truth: the nearest is tracer, 64 samples: "
                  "1.01 % (0.9 to 1.1)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_answer_has_ten_lines_at_most),
        cmocka_unit_test(test_words_of_differences),
        cmocka_unit_test(test_the_cheapest_series_at_an_error),
        cmocka_unit_test(test_steps_for_an_error_of_the_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

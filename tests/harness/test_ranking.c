/* SPDX-License-Identifier: MIT
 *
 * The engine with the largest error in a report, and the reason: frames with an error in closed
 * form.
 */
#include "tests/harness/image_test.h"

#include "harness/engines/engines.h"
#include "harness/report/ranking.h"

enum { SIDE = 64, FRAMES = 3 };

static double none(int x, int y)
{
    (void)x, (void)y;
    return 0.0;
}

/* +0.1 and -0.1 alternate: a mean of 0, an RMSE of 0.1. */
static double alternating(int x, int y)
{
    return (x + y) % 2 == 0 ? 0.1 : -0.1;
}

static double offset(int x, int y)
{
    (void)x, (void)y;
    return 0.02;
}

/* The reference has a step in brightness at x = 32; the error is in the two columns next to it. */
static double at_step(int x, int y)
{
    (void)y;
    return x == 31 || x == 32 ? 0.25 : 0.0;
}

/* Grey 1 plus an error; `step`: the right half is twice as bright. */
static struct neph_image *make_error_image(double (*error)(int x, int y), bool step)
{
    struct neph_image *image = grey_image(SIDE, SIDE, 1.0);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            set_grey(image, (size_t)y * SIDE + (size_t)x,
                     (step && x >= SIDE / 2 ? 2.0 : 1.0) + error(x, y));
    return image;
}

/* ---- parts of the error ---------------------------------------------------------------------- */

static struct neph_error_parts measure_error_parts(struct neph_image *reference,
                                                   struct neph_image *test,
                                                   struct neph_image *second)
{
    struct neph_error_parts parts;
    struct neph_diag diag = {0};
    const struct neph_error_frames frames = {reference, reference, test, second};
    neph_assert_ok(neph_error_parts(&frames, &parts, &diag), &diag);
    if (second != test)
        neph_image_destroy(second);
    neph_image_destroy(test);
    neph_image_destroy(reference);
    return parts;
}

static void test_an_offset_is_all_of_its_error(void **state)
{
    (void)state;
    struct neph_image *test = make_error_image(offset, false);
    const struct neph_error_parts parts = measure_error_parts(make_error_image(none, false), test,
                                                              test);
    neph_assert_close(parts.offset_share, 1.0, 1e-5,
                      0.0); /* float32 frames: 6e-8 / 0.02, squared */
    neph_assert_close(parts.noise_share, 0.0, 0.0, 0.0);
    neph_assert_close(parts.edge_share, 0.0, 0.0, 0.0);
    neph_assert_close(parts.edge_pixel_share, 0.0, 0.0, 0.0);
}

/* Two frames with errors +e and -e differ by 2 e: half of its square is twice the squared error of
 * one frame. */
static void test_noise_from_two_seeds(void **state)
{
    (void)state;
    struct neph_image *test = make_error_image(alternating, false),
                      *second = make_error_image(none, false);
    const struct neph_error_parts parts = measure_error_parts(make_error_image(none, false), test,
                                                              second);
    neph_assert_close(parts.noise_share, 0.5, 1e-5, 0.0);
    neph_assert_close(parts.offset_share, 0.0, 0.0, 1e-9);
    struct neph_image *lone = make_error_image(alternating, false);
    assert_true(isnan(measure_error_parts(make_error_image(none, false), lone, NULL).noise_share));
}

/* Columns 31 - 2 to 32 + 2 are at the step: 6 of 64. */
static void test_edges_are_those_of_the_reference(void **state)
{
    (void)state;
    struct neph_image *test = make_error_image(at_step, true);
    const struct neph_error_parts parts = measure_error_parts(make_error_image(none, true), test,
                                                              test);
    neph_assert_close(parts.edge_share, 1.0, 1e-12, 0.0);
    neph_assert_close(parts.edge_pixel_share, 6.0 / SIDE, 1e-12, 0.0);
}

static void test_frames_without_a_difference_have_no_parts(void **state)
{
    (void)state;
    struct neph_image *test = make_error_image(none, false);
    assert_true(isnan(measure_error_parts(make_error_image(none, false), test, test).offset_share));
}

/* ---- order ----------------------------------------------------------------------------------- */

static void measure(struct neph_frame_result *frame, const char *engine,
                    double (*error)(int x, int y), bool step)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_diag diag = {0};
    struct neph_image *reference = make_error_image(none, step),
                      *test = make_error_image(error, step);
    const struct neph_error_frames frames = {reference, reference, test, test};
    *frame = (struct neph_frame_result){
        .engine = neph_engine_find(engine), .reason = "", .note = "", .settings = ""};
    neph_assert_ok(neph_measure(reference, test, NULL, &viewing, &frame->measurements, &diag),
                   &diag);
    neph_assert_ok(neph_error_parts(&frames, &frame->error_parts, &diag), &diag);
    neph_image_destroy(test);
    neph_image_destroy(reference);
}

struct run {
    struct neph_arena arena;
    struct neph_frame_result frames[FRAMES];
    struct neph_gate_result gate;
    struct neph_scene_result scene;
    struct neph_validation validation;
};

/* exact is the truth, march is 2 % too bright, realtime has no bias and an RMSE of 10 %. */
static void begin(struct run *run)
{
    *run = (struct run){.scene = {.name = "slab", .frame_count = FRAMES, .truth = 0}};
    run->frames[0] = (struct neph_frame_result){.engine = neph_engine_find("exact"), .note = ""};
    measure(&run->frames[1], "march", offset, false);
    measure(&run->frames[2], "realtime", alternating, false);
    run->scene.frames = run->frames;
    run->scene.gates = &run->gate;
    run->validation = (struct neph_validation){.scene_count = 1, .scenes = &run->scene};
}

static void end(struct run *run)
{
    for (int f = 0; f < FRAMES; f++)
        neph_measurements_finish(&run->frames[f].measurements);
    neph_arena_finish(&run->arena);
}

static void test_a_small_bias_does_not_hide_a_large_rmse(void **state)
{
    (void)state;
    struct run run;
    struct neph_ranked list[FRAMES];
    begin(&run);
    const struct neph_measurement *bias = neph_measurement_find(&run.frames[2].measurements,
                                                                "radiance", "rel_bias", "all");
    neph_assert_close(bias->value, 0.0, 0.0, 1e-6);
    assert_int_equal(neph_ranking(&run.validation, list, FRAMES), 2);
    assert_string_equal(list[0].frame->engine->name, "realtime");
    neph_assert_close(list[0].number->value, 0.1, 1e-5, 0.0);
    assert_string_equal(list[1].frame->engine->name, "march");
    neph_assert_close(list[1].number->value, 0.02, 1e-5, 0.0);
    end(&run);
}

static void test_a_failed_gate_comes_first(void **state)
{
    (void)state;
    struct run run;
    struct neph_ranked list[FRAMES];
    begin(&run);
    run.gate = (struct neph_gate_result){.engine = "march", .verdict = NEPH_GATE_FAIL};
    run.scene.gate_count = 1;
    neph_ranking(&run.validation, list, FRAMES);
    assert_string_equal(list[0].frame->engine->name, "march");
    assert_true(list[0].is_failing);
    assert_false(list[1].is_failing);
    run.scene.truth = -1; /* no reference to compare with */
    assert_int_equal(neph_ranking(&run.validation, list, FRAMES), 0);
    end(&run);
}

static void test_the_cause_follows_the_measures(void **state)
{
    (void)state;
    struct run run;
    struct neph_ranked list[FRAMES];
    begin(&run);
    neph_ranking(&run.validation, list, FRAMES);
    const char *realtime = neph_ranked_cause(&list[0], &run.arena);
    const char *march = neph_ranked_cause(&list[1], &run.arena);
    assert_non_null(strstr(march, "one offset of the whole frame, +2\u00a0%"));
    assert_non_null(strstr(march, "Where: spread over the frame"));
    assert_non_null(strstr(realtime, "march, the ray marcher with the same lighting"));
    assert_non_null(strstr(realtime, "has an error of 2\u00a0%: the error comes from the reuse"));
    neph_measurements_finish(&run.frames[2].measurements);
    measure(&run.frames[2], "realtime", at_step, true);
    neph_ranking(&run.validation, list, FRAMES);
    assert_non_null(
        strstr(neph_ranked_cause(&list[0], &run.arena),
               "lies within 2\u00a0px of edges of brightness (9\u00a0% of the pixels)"));
    run.frames[2].is_look = true;
    assert_non_null(strstr(neph_ranked_cause(&list[0], &run.arena), "claims no physics"));
    end(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_offset_is_all_of_its_error),
        cmocka_unit_test(test_noise_from_two_seeds),
        cmocka_unit_test(test_edges_are_those_of_the_reference),
        cmocka_unit_test(test_frames_without_a_difference_have_no_parts),
        cmocka_unit_test(test_a_small_bias_does_not_hide_a_large_rmse),
        cmocka_unit_test(test_a_failed_gate_comes_first),
        cmocka_unit_test(test_the_cause_follows_the_measures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

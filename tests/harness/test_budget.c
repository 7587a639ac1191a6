/* SPDX-License-Identifier: MIT
 *
 * Time budgets, with a synthetic engine that takes a second for each sample of each pixel and stops
 * when that exceeds its limit. Its noise is known: a pixel is 1 + u / sqrt(samples) with u uniform
 * in -0.5 .. 0.5.
 */
#include "tests/harness/store_test.h"

#include "base/exr.h"
#include "harness/run/budget.h"

enum { WIDTH = 64, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

/* Simulated seconds of the engine: samples times pixels. */
static const double start_s = 1000.0;

static const struct neph_option options[] = {
    {.name = "samples",
     .kind = NEPH_OPTION_INTEGER,
     .default_value = 64,
     .minimum = 1,
     .maximum = 8192,
     .help = "of a pixel"},
    {.name = NULL},
};

static void probe(const struct neph_engine *engine, struct neph_shared_device *device,
                  struct neph_engine_info *info)
{
    (void)engine, (void)device;
    *info = (struct neph_engine_info){.available = true, .version = "1", .device = "none"};
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)scene, (void)settings, (void)reason, (void)reason_size;
    return true;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const double samples = shot->settings.values[0];
    const size_t pixels = (size_t)shot->width_px * (size_t)shot->height_px;
    uint64_t state = shot->seed;
    float *planes[3];
    *cost = (struct neph_cost){.wall_s = start_s + samples * (double)pixels,
                               .render_s = samples * (double)pixels};
    if (cost->wall_s > shot->time_limit_s)
        return neph_fail(diag, NEPH_ERR_TIMEOUT, "stopped after %g s", shot->time_limit_s);
    neph_assert_ok(neph_image_create(shot->width_px, shot->height_px, frame, diag), diag);
    neph_assert_ok(neph_image_add_rgb(*frame, NULL, planes, diag), diag);
    for (size_t p = 0; p < pixels; p++)
        for (int c = 0; c < 3; c++)
            planes[c][p] = (float)(1.0 + neph_test_uniform(&state, -0.5, 0.5) / sqrt(samples));
    return NEPH_OK;
}

static enum neph_status hang(const struct neph_shot *shot, struct neph_image **frame,
                             struct neph_cost *cost, struct neph_diag *diag)
{
    *cost = (struct neph_cost){.wall_s = shot->time_limit_s};
    return neph_fail(diag, NEPH_ERR_TIMEOUT, "stopped after %g s", shot->time_limit_s);
}

#define ENGINE(name_, render_, stochastic_)                                                        \
    {                                                                                              \
        .name = name_, .summary = "made up", .rung = NEPH_LEVEL_EXTERNAL, .options = options,      \
        .version = 1, .stochastic = stochastic_, .probe = probe, .can_render = can_render,         \
        .render = render_                                                                          \
    }
static const struct neph_engine sampler = ENGINE("sampler", render, true);
static const struct neph_engine marcher = ENGINE("marcher", render, false);
static const struct neph_engine stuck = ENGINE("stuck", hang, true);

/* One store for all renders of a test. */
struct bench {
    struct neph_store *store;
    struct neph_scene scene;
    struct neph_engine_info info;
};

static struct bench open_bench(void **state)
{
    return (struct bench){.store = open_store(state),
                          .scene = {.name = "none", .hash = "0", .medium_count = 1}};
}

static struct neph_job make_job(struct bench *bench, const struct neph_engine *engine)
{
    engine->probe(engine, NULL, &bench->info);
    return (struct neph_job){.engine = engine,
                             .info = &bench->info,
                             .shot = {.scene = &bench->scene,
                                      .settings = neph_settings_default(engine),
                                      .width_px = WIDTH,
                                      .height_px = HEIGHT,
                                      .layers = NEPH_LAYER_RADIANCE,
                                      .seed = 1}};
}

static struct neph_job_result run(struct bench *bench, const struct neph_engine *engine,
                                  double budget_s, double *samples)
{
    struct neph_diag diag = {0};
    struct neph_job_result result;
    struct neph_job job = make_job(bench, engine);
    neph_assert_ok(neph_budget_run(&job, budget_s, bench->store, &result, &diag), &diag);
    *samples = job.shot.settings.values[0];
    return result;
}

static const double all_s = start_s + 64.0 * PIXELS, eighth_s = start_s + 8.0 * PIXELS,
                    least_s = start_s + 1.0 * PIXELS;

static void test_fitting_frames_are_unchanged(void **state)
{
    struct bench bench = open_bench(state);
    double samples;
    struct neph_job_result result = run(&bench, &sampler, all_s, &samples);
    assert_int_equal(result.outcome, NEPH_OUTCOME_RENDERED);
    assert_true(samples == 64.0);
    assert_string_equal(result.note, "");
    neph_job_result_finish(&result);
    neph_store_close(bench.store);
}

/* neph_budget_try() reduces no samples, and uses frames of the store. */
static void test_the_first_step_gives_no_samples_up(void **state)
{
    struct bench bench = open_bench(state);
    struct neph_diag diag = {0};
    struct neph_job_result result;
    const struct {
        double budget_s, samples;
        enum neph_outcome outcome;
    } cases[] = {{all_s - 1.0, 64.0, NEPH_OUTCOME_TIMEOUT},
                 {all_s - 1.0, 8.0, NEPH_OUTCOME_RENDERED}};
    for (int i = 0; i < 2; i++) {
        struct neph_job job = make_job(&bench, &sampler);
        neph_assert_ok(neph_budget_try(&job, cases[i].budget_s, bench.store, &result, &diag),
                       &diag);
        assert_int_equal(result.outcome, cases[i].outcome);
        assert_true(job.shot.settings.values[0] == cases[i].samples);
        neph_job_result_finish(&result);
        double samples;
        result = run(&bench, &sampler, cases[i].budget_s, &samples); /* the store has 8 samples now
                                                                        */
        assert_true(samples == 8.0);
        neph_job_result_finish(&result);
    }
    neph_store_close(bench.store);
}

static void test_large_frames_get_fewer_samples(void **state)
{
    const struct {
        double budget_s, samples;
        const char *said;
    } cases[] = {{all_s - 1.0, 8.0, "rendered with 8, whose noise is 2.8 times"},
                 {eighth_s, 8.0, "64 samples"},
                 {eighth_s - 1.0, 1.0, "rendered with 1, whose noise is 8.0 times"},
                 {least_s, 1.0, "did not fit"}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct bench bench = open_bench(state);
        double samples;
        snprintf(bench.scene.hash, sizeof(bench.scene.hash), "%zu", i);
        struct neph_job_result result = run(&bench, &sampler, cases[i].budget_s, &samples);
        assert_int_equal(result.outcome, NEPH_OUTCOME_RENDERED);
        assert_true(samples == cases[i].samples);
        assert_non_null(strstr(result.note, cases[i].said));
        neph_job_result_finish(&result);
        neph_store_close(bench.store);
    }
}

/* A larger budget still uses the store first; a frame with more samples is preferred. */
static void test_stored_frames_are_used(void **state)
{
    struct bench bench = open_bench(state);
    double samples;
    struct neph_job_result result = run(&bench, &sampler, eighth_s, &samples);
    neph_job_result_finish(&result);
    result = run(&bench, &sampler, all_s, &samples);
    assert_true(result.reused);
    assert_true(samples == 8.0);
    assert_non_null(strstr(result.note, "rendered with 8"));
    neph_job_result_finish(&result);
    neph_store_close(bench.store);
}

/* The number after `before` in `text`. */
static double number_after(const char *text, const char *before)
{
    const char *place = strstr(text, before);
    assert_non_null(place);
    return strtod(place + strlen(before), NULL);
}

/* Not even one sample per pixel fits: a frame of a quarter of the side gives time and noise. A
 * uniform number of width 1 has a variance of 1/12. The noise is printed with two digits, from 144
 * * 3 * 2 values whose own scatter is sqrt(4/5 / 864), 3 %. */
static void test_over_budget_frames_report_noise(void **state)
{
    struct bench bench = open_bench(state);
    double samples;
    struct neph_job_result result = run(&bench, &sampler, least_s - 1.0, &samples);
    assert_int_equal(result.outcome, NEPH_OUTCOME_OVER_BUDGET);
    assert_null(result.frame_path);
    assert_true(fabs(number_after(result.reason, "its radiance would take ") - all_s) < 1.0);
    const double noise = number_after(result.reason, "noise would be about ") / 100.0;
    const double expected = sqrt(1.0 / 13.0 / 64.0);
    assert_true(fabs(noise / expected - 1.0) < 4.0 * 0.03);
    neph_job_result_finish(&result);
    neph_store_close(bench.store);
}

/* A deterministic engine has no samples to reduce. */
static void test_nothing_is_given_up_without_chance(void **state)
{
    struct bench bench = open_bench(state);
    double samples;
    struct neph_job_result result = run(&bench, &marcher, all_s - 1.0, &samples);
    assert_int_equal(result.outcome, NEPH_OUTCOME_OVER_BUDGET);
    assert_null(strstr(result.reason, "noise"));
    assert_true(samples == 64.0);
    neph_job_result_finish(&result);
    neph_store_close(bench.store);
}

/* An engine that never ends is broken, not slow: that fails a run. */
static void test_a_hanging_engine_is_a_timeout(void **state)
{
    struct bench bench = open_bench(state);
    double samples;
    struct neph_job_result result = run(&bench, &stuck, 1.0, &samples);
    assert_int_equal(result.outcome, NEPH_OUTCOME_TIMEOUT);
    neph_job_result_finish(&result);
    neph_store_close(bench.store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_fitting_frames_are_unchanged),
        scratch_test(test_the_first_step_gives_no_samples_up),
        scratch_test(test_large_frames_get_fewer_samples),
        scratch_test(test_stored_frames_are_used),
        scratch_test(test_over_budget_frames_report_noise),
        scratch_test(test_nothing_is_given_up_without_chance),
        scratch_test(test_a_hanging_engine_is_a_timeout),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: MIT
 *
 * The step-halving study on synthetic engines with known bias and noise: radiance 1 + 0.2 step^2 +
 * noise; the noise of a pixel is either equal at all steps (paths with the same seed) or not.
 */
#include "tests/base/scratch.h"

#include "harness/study/study.h"

enum { WIDTH = 64, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

static const double bias_of_step = 0.2, noise_of_pixel = 0.5;

static const struct neph_option options[] = {
    {.name = "step",
     .kind = NEPH_OPTION_REAL,
     .default_value = 0.2,
     .minimum = 1e-3,
     .maximum = 1.0,
     .help = "of the integrator"},
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

static enum neph_status render(const struct neph_shot *shot, uint64_t stream,
                               struct neph_image **frame, struct neph_cost *cost,
                               struct neph_diag *diag)
{
    const double step = shot->settings.values[0];
    uint64_t state = 1000 * shot->seed + stream;
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, frame, diag), diag);
    neph_assert_ok(neph_image_add_rgb(*frame, NULL, planes, diag), diag);
    for (int p = 0; p < PIXELS; p++) {
        const double noise = noise_of_pixel * neph_test_uniform(&state, -1.0, 1.0);
        for (int c = 0; c < 3; c++)
            planes[c][p] = (float)(1.0 + bias_of_step * step * step + noise);
    }
    *cost = (struct neph_cost){.wall_s = 1.0};
    return NEPH_OK;
}

static enum neph_status render_shared(const struct neph_shot *shot, struct neph_image **frame,
                                      struct neph_cost *cost, struct neph_diag *diag)
{
    return render(shot, 0, frame, cost, diag);
}

static enum neph_status render_fresh(const struct neph_shot *shot, struct neph_image **frame,
                                     struct neph_cost *cost, struct neph_diag *diag)
{
    return render(shot, (uint64_t)(1e6 * shot->settings.values[0]), frame, cost, diag);
}

static enum neph_status render_rough(const struct neph_shot *shot, struct neph_image **frame,
                                     struct neph_cost *cost, struct neph_diag *diag)
{
    struct neph_shot rough = *shot; /* step^0.8 in place of step^2 */
    rough.settings.values[0] = pow(shot->settings.values[0], 0.4);
    return render(&rough, 0, frame, cost, diag);
}

static enum neph_status render_black(const struct neph_shot *shot, struct neph_image **frame,
                                     struct neph_cost *cost, struct neph_diag *diag)
{
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, frame, diag), diag);
    *cost = (struct neph_cost){.wall_s = 1.0};
    return neph_image_add_rgb(*frame, NULL, planes, diag);
}

#define ENGINE(name_, render_)                                                                     \
    {                                                                                              \
        .name = name_, .summary = "made up", .rung = NEPH_LEVEL_EXTERNAL, .options = options,      \
        .version = 1, .stochastic = true,                                                          \
        .step = {.option = "step", .coarsest = 0.4, .refine = 0.5, .level_count = 4, .order = 2},  \
        .probe = probe, .can_render = can_render, .render = render_                                \
    }
static const struct neph_engine shared = ENGINE("shared", render_shared);
static const struct neph_engine fresh = ENGINE("fresh", render_fresh);
static const struct neph_engine rough = ENGINE("rough", render_rough);
static const struct neph_engine black = ENGINE("black", render_black);

static struct neph_study run(const struct neph_engine *engine, void **state,
                             enum neph_outcome expected)
{
    char folder[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_store *store = NULL;
    struct neph_study study;
    struct neph_engine_info info;
    struct neph_scene scene = {.name = "none", .hash = "0", .medium_count = 1};
    enum neph_outcome outcome;
    char reason[1600];
    engine->probe(engine, NULL, &info);
    const struct neph_job job = {.engine = engine,
                                 .info = &info,
                                 .shot = {.scene = &scene,
                                          .settings = neph_settings_default(engine),
                                          .width_px = WIDTH,
                                          .height_px = HEIGHT,
                                          .layers = NEPH_LAYER_RADIANCE,
                                          .seed = 1}};
    neph_assert_ok(neph_store_open(scratch_path(state, folder, "store"), &store, &diag), &diag);
    neph_assert_ok(neph_study_run(&job, store, &study, &outcome, reason, &diag), &diag);
    assert_int_equal(outcome, expected);
    neph_store_close(store);
    return study;
}

/* Uniform noise of variance a^2 / 3; two seeds with PIXELS pixels each. */
static double noise_of_mean(void)
{
    return noise_of_pixel / sqrt(3.0) / sqrt(2.0 * PIXELS);
}

static void test_shared_noise_cancels(void **state)
{
    const struct neph_study study = run(&shared, state, NEPH_OUTCOME_RENDERED);
    assert_int_equal(study.level_count, 4);
    for (int i = 0; i < 4; i++) {
        const double step = 0.4 / (1 << i);
        neph_assert_close(study.levels[i].setting, step, 1e-15, 0);
        neph_assert_close(study.levels[i].noise, noise_of_mean(), 0.1, 0);
        /* relative to a limit that depends on the noise; frames are floats */
        neph_assert_close(study.levels[i].bias, bias_of_step * step * step, 4.0 * noise_of_mean(),
                          1e-7);
        assert_true(study.levels[i].bias_noise < 1e-7);
    }
    neph_assert_close(study.observed_order, 2.0, 1e-3, 0);
    assert_int_equal(study.verdict, NEPH_STUDY_WITHIN);
    assert_int_equal(study.chosen, 3); /* 0.05: 0.05 %; 0.1 has 0.2 % */
}

static void test_fresh_noise_stays(void **state)
{
    const struct neph_study study = run(&fresh, state, NEPH_OUTCOME_RENDERED);
    const double limit_noise = hypot(4.0, 1.0) / 3.0 * noise_of_mean();
    neph_assert_close(study.levels[0].bias_noise,
                      hypot(1.0, limit_noise / noise_of_mean()) * noise_of_mean(), 0.1, 0);
    neph_assert_close(study.limit, 1.0, 0, 4.0 * limit_noise);
    assert_true(fabs(study.levels[0].bias - bias_of_step * 0.16) <
                4.0 * study.levels[0].bias_noise);
    assert_int_equal(study.verdict, NEPH_STUDY_NOISE);
}

/* An error that decreases more slowly than the declared order has no limit that the last two steps
 * determine. */
static void test_a_wrong_order_is_reported(void **state)
{
    const struct neph_study study = run(&rough, state, NEPH_OUTCOME_RENDERED);
    neph_assert_close(study.observed_order, 0.8, 1e-2, 0);
    assert_int_equal(study.verdict, NEPH_STUDY_OFF);
    assert_int_equal(study.chosen, study.level_count - 1);
}

static void test_black_frames_are_not_studied(void **state)
{
    run(&black, state, NEPH_OUTCOME_CANNOT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_shared_noise_cancels),
        scratch_test(test_fresh_noise_stays),
        scratch_test(test_a_wrong_order_is_reported),
        scratch_test(test_black_frames_are_not_studied),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

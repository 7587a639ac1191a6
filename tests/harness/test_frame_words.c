/* SPDX-License-Identifier: MIT
 *
 * Notes beside a frame: the optical depth of a marcher's step, the noise; and the seeds that make
 * scenes independent.
 */
#include "tests/scene_builders.h"

#include "harness/engines/engines.h"
#include "harness/report/step_bias.h"
#include "harness/report/step_depth.h"
#include "harness/run/noise.h"
#include "harness/run/seed.h"
#include "scenes/medium_bounds.h"
#include "scenes/solids.h"

/* A slab 10 m deep, seen perpendicularly. */
struct stage {
    struct neph_scene scene;
    struct neph_camera_key key;
};

static void make_slab(struct stage *stage, double optical_depth)
{
    *stage = (struct stage){.key = {.position_m = {0, 0, 20}, .look_at_m = {0, 0, 0}}};
    stage->scene = (struct neph_scene){
        .camera_key_count = 1,
        .camera_keys = &stage->key,
        .camera_up = {0, 1, 0},
        .vertical_fov_rad = 0.1,
        .frame_count = 1,
        .medium_count = 1,
        .media = {{.kind = NEPH_MEDIUM_GAUSSIAN,
                   .bounds = {{-50, -50, -5}, {50, 50, 5}},
                   .extinction_color = white,
                   .albedo = white,
                   /* wide enough to be constant */
                   .gaussian = {{0, 0, 0}, 1e4},
                   .extinction_per_m = 0.1 * optical_depth}},
    };
}

static double step_depth(const struct stage *stage, const char *engine_name)
{
    const struct neph_engine *engine = neph_engine_find(engine_name);
    assert_non_null(engine);
    const struct neph_shot shot = {.scene = &stage->scene,
                                   .settings = neph_settings_default(engine),
                                   .width_px = 64,
                                   .height_px = 36};
    return neph_step_depth(&shot, engine);
}

/* Depth / steps, within the slant of the outermost rays: 1 / cos 0.1. */
static void test_a_step_spans_its_part_of_the_depth(void **state)
{
    const struct neph_engine *povray = neph_engine_find("povray");
    const struct neph_settings settings = neph_settings_default(povray);
    const double intervals = neph_setting(povray, &settings, "intervals");
    struct stage stage;
    for (double depth = 4.0; depth < 2000.0; depth *= 4.0) {
        make_slab(&stage, depth);
        neph_assert_close(step_depth(&stage, "march"), depth / 64.0, 0.01, 0.0);
        neph_assert_close(step_depth(&stage, "povray"), depth / intervals, 0.01, 0.0);
        assert_true(isnan(step_depth(&stage, "exact")));
    }
}

static void test_long_steps_give_a_warning(void **state)
{
    struct stage stage;
    const struct neph_engine *march = neph_engine_find("march");
    make_slab(&stage, 1000.0);
    char *warning = neph_step_depth_warning(step_depth(&stage, "march"), march);
    assert_non_null(warning);
    assert_non_null(strstr(warning, "raise its steps"));
    free(warning);
    make_slab(&stage, 10.0);
    assert_null(neph_step_depth_warning(step_depth(&stage, "march"), march));
    assert_null(neph_step_depth_warning(NAN, march));
}

/* With the estimate's own steps; the frame has only light of the media, or half of it. */
static double find_step_bias(const struct neph_shot *shot, const struct neph_engine *engine,
                             float behind)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    float *all[3], *volume[3];
    neph_assert_ok(neph_image_create(64, 36, &frame, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(frame, NULL, all, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(frame, "volume", volume, &diag), &diag);
    for (int i = 0; i < 3 * 64 * 36; i++) {
        volume[i / (64 * 36)][i % (64 * 36)] = 1.0f;
        all[i / (64 * 36)][i % (64 * 36)] = 1.0f + behind;
    }
    const double bias = neph_step_bias(shot, engine, frame);
    neph_image_destroy(frame);
    return bias;
}

static double step_bias(const struct stage *stage, const char *engine_name, float behind)
{
    const struct neph_engine *engine = neph_engine_find(engine_name);
    const struct neph_shot shot = {.scene = &stage->scene,
                                   .settings = neph_settings_default(engine),
                                   .width_px = 64,
                                   .height_px = 36};
    return find_step_bias(&shot, engine, behind);
}

/* With the sun behind the camera both path lengths are equal, and a marcher gets 1 / cosh(x / 2) of
 * the light of a step of optical depth x. The estimate is twice the difference to half of the
 * steps. */
static void test_the_step_bias_of_a_slab(void **state)
{
    struct stage stage;
    for (double depth = 4.0; depth < 400.0; depth *= 4.0) {
        make_slab(&stage, depth);
        stage.scene.sun = (struct neph_sun){true, {0, 0, 1}, {3, 3, 3}};
        stage.scene.scattering = NEPH_SCATTERING_SINGLE;
        const double x = depth / 64.0;
        const double bias = 2.0 * (cosh(x / 4.0) / cosh(x / 2.0) - 1.0);
        neph_assert_close(step_bias(&stage, "march", 0.0f), bias, 0.02, 1e-6);
        neph_assert_close(step_bias(&stage, "march", 1.0f), 0.5 * bias, 0.02, 1e-6);
        assert_true(isnan(step_bias(&stage, "exact", 0.0f)));
    }
    const struct neph_engine *march = neph_engine_find("march");
    char *warning = neph_step_bias_warning(step_bias(&stage, "march", 0.0f), march);
    assert_non_null(warning);
    assert_non_null(strstr(warning, "too dark: raise its steps"));
    free(warning);
    assert_null(neph_step_bias_warning(0.09, march));
    assert_null(neph_step_bias_warning(-0.09, march));
    assert_null(neph_step_bias_warning(NAN, march));
}

/* A slab that is turned with its camera and its sun has the steps of the slab: between the turned
 * faces, not between those of the box around them. */
static void test_the_steps_of_a_turned_slab(void **state)
{
    const struct neph_turn turn = {1, cos(0.5), sin(0.5)};
    double bias[2], depth[2];
    for (int is_turned = 0; is_turned < 2; is_turned++) {
        struct stage stage;
        make_slab(&stage, 100.0);
        stage.scene.sun = (struct neph_sun){true, {0, 0, 1}, {3, 3, 3}};
        stage.scene.scattering = NEPH_SCATTERING_SINGLE;
        if (is_turned) {
            neph_medium_turn_bounds(&stage.scene.media[0], &turn);
            stage.key.position_m = neph_rotate(&turn, stage.key.position_m);
            stage.scene.sun.direction = neph_rotate(&turn, stage.scene.sun.direction);
        }
        bias[is_turned] = step_bias(&stage, "march", 0.0f);
        depth[is_turned] = step_depth(&stage, "march");
    }
    print_message("step bias of a slab %.6f, turned %.6f; depth of a step %.6f, turned %.6f\n",
                  bias[0], bias[1], depth[0], depth[1]);
    neph_assert_close(bias[1], bias[0], 1e-9, 0.0); /* rounding in double */
    neph_assert_close(depth[1], depth[0], 1e-9, 0.0);
}

/* 40 rays with n and with 2 n steps are a million steps where n is 8,333. */
static void test_of_many_steps_no_bias_is_estimated(void **state)
{
    const struct neph_engine *march = neph_engine_find("march");
    struct stage stage;
    make_slab(&stage, 4.0);
    stage.scene.sun = (struct neph_sun){true, {0, 0, 1}, {3, 3, 3}};
    stage.scene.scattering = NEPH_SCATTERING_SINGLE;
    struct neph_shot shot = {.scene = &stage.scene,
                             .settings = neph_settings_default(march),
                             .width_px = 64,
                             .height_px = 36};
    double *steps = &shot.settings.values[neph_option_find(march->options, "steps")];
    *steps = 8333;
    assert_false(isnan(find_step_bias(&shot, march, 0.0f)));
    assert_null(neph_step_bias_omission(&shot, march));
    *steps = 8334;
    assert_true(isnan(find_step_bias(&shot, march, 0.0f)));
    char *omission = neph_step_bias_omission(&shot, march);
    assert_string_equal(omission,
                        "step bias not estimated: 8334 steps, at most 8333 are marched again");
    free(omission);
}

static void test_scenes_have_seeds_of_their_own(void **state)
{
    struct neph_scene a = {.hash = "0a"}, b = {.hash = "0b"};
    assert_true(neph_seed_for_scene(&a, 1) == neph_seed_for_scene(&a, 1));
    assert_true(neph_seed_for_scene(&a, 1) != neph_seed_for_scene(&a, 2));
    assert_true(neph_seed_for_scene(&a, 1) != neph_seed_for_scene(&b, 1));
    for (int i = 1; i < 1000; i++)
        assert_true(neph_seed_for_scene(&a, i) >= 1 && neph_seed_for_scene(&a, i) <= 0x7fffffff);
}

static struct neph_image *noisy(uint64_t seed, double noise)
{
    struct neph_image *image = NULL;
    float *rgb[3], *variance[3];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(64, 64, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, rgb, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, "variance", variance, &diag), &diag);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 64 * 64; i++) {
            /* uniform of variance 1 */
            const double x = neph_test_uniform(&seed, -sqrt(3.0), sqrt(3.0));
            rgb[c][i] = (float)(2.0 + noise * x);
            variance[c][i] = (float)(noise * noise);
        }
    return image;
}

/* Both estimates, from 12288 numbers: to sqrt(2 / 12288) and four times that. */
static void test_noise_is_known(void **state)
{
    struct neph_image *a = noisy(1, 0.02), *b = noisy(2, 0.02);
    neph_assert_close(neph_noise_from_variance(a), 0.01, 0.01, 0.0);
    neph_assert_close(neph_noise_from_two_seeds(a, b), 0.01, 4.0 * sqrt(2.0 / 12288.0), 0.0);
    assert_true(neph_noise_from_two_seeds(a, a) == 0.0);
    neph_image_destroy(a);
    neph_image_destroy(b);
}

#include "tests/main.h"

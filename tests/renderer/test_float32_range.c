/* SPDX-License-Identifier: MIT
 *
 * Scenes too far from the camera for float32 are refused, and scenes just within range are rendered
 * correctly: a face of an opaque box compared with the closed form of the half-space.
 */
#include "tests/renderer/frames.h"

#include "renderer/float32_range.h"
#include "renderer/tracer.h"

static const double tiny_fov_rad = 2e-3;

/* A cube of fog around a point in front of the camera. */
static struct neph_medium *add_cube(struct test_scene *test, double extinction_per_m,
                                    double distance_m, double half_side_m)
{
    struct neph_medium *medium = test_add_medium(test, extinction_per_m, 0.0, 0.0);
    const double front_m = -distance_m, back_m = -distance_m - 2.0 * half_side_m;
    medium->bounds = (struct neph_bounds){{-half_side_m, 1.6 - half_side_m, back_m},
                                          {half_side_m, 1.6 + half_side_m, front_m}};
    return medium;
}

static void init_far(struct test_scene *test)
{
    test_scene_init(test);
    test->scene.vertical_fov_rad = tiny_fov_rad;
    test->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.3, 0.4, 0.8});
    test->scene.background_w_per_m2_sr = (struct neph_rgb){0.0, 0.0, 0.0};
}

static void scene_near_cube(struct test_scene *test)
{
    add_cube(test, 1.0, 9e4, 500.0);
}

static void scene_far_cube(struct test_scene *test)
{
    add_cube(test, 1.0, 1.1e5, 500.0);
}

static void scene_far_thin_cube(struct test_scene *test)
{
    add_cube(test, 0.01, 9e5, 5000.0);
}

static void scene_far_key(struct test_scene *test)
{
    static struct neph_camera_key keys[2];
    keys[0] = test->key;
    keys[1] = (struct neph_camera_key){10.0, {0.0, 1.6, 5e5}, {0.0, 1.6, 0.0}, false};
    test->scene.camera_keys = keys;
    test->scene.camera_key_count = 2;
    add_cube(test, 1.0, 5e4, 500.0);
}

static void scene_inside_dense_fog(struct test_scene *test)
{
    test_add_medium(test, 1e9, 0.0, 0.0);
}

static struct neph_medium *add_blob(struct test_scene *test)
{
    struct neph_medium *medium = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 10.0);
    medium->gaussian = (struct neph_gaussian){{0.0, 1.6, -9e5}, 500.0};
    return medium;
}

/* It has a soft edge; measured against quadrature: 7e-4 rms. */
static void scene_far_blob(struct test_scene *test)
{
    add_blob(test);
}

static void scene_far_cut_blob(struct test_scene *test)
{
    add_blob(test)->bounds.max_m.z = -9e5;
}

static void scene_steep_fog_far_below(struct test_scene *test)
{
    test->key.position_m.y = 1e6;
    test->key.look_at_m.y = 0.0;
    test_add_medium(test, 1.0, 1.0, 0.0);
}

static void scene_soft_fog_far_below(struct test_scene *test)
{
    test->key.position_m.y = 1e6;
    test->key.look_at_m.y = 0.0;
    test_add_medium(test, 1.0, 0.01, 0.0);
}

/* The half-space below the ground; all rays start above it. */
static void look_down_in_parallel(struct test_scene *test, double height_m)
{
    test->scene.vertical_fov_rad = 0.0;
    test->scene.orthographic_height_m = height_m;
    test->key.position_m = (struct neph_vec3){0.0, 0.4 * height_m, 0.0};
    test->key.look_at_m = (struct neph_vec3){4.0, 0.4 * height_m - 6.0, -5.0};
    test_add_medium(test, 1.0, 0.0, 0.0)->bounds.max_m.y = 0.0;
}

static void scene_parallel_near(struct test_scene *test)
{
    look_down_in_parallel(test, 9e4);
}

static void scene_parallel_far(struct test_scene *test)
{
    look_down_in_parallel(test, 1e5);
}

static const struct {
    const char *name;
    void (*make)(struct test_scene *test);
    bool is_within;
} cases[] = {
    {"an opaque cube at 9e4 mean free paths", scene_near_cube, true},
    {"an opaque cube at 1.1e5", scene_far_cube, false},
    {"a thin cube at 9e5 m", scene_far_thin_cube, true},
    {"a camera that goes far away", scene_far_key, false},
    {"a camera inside dense fog", scene_inside_dense_fog, true},
    {"a blob at 9e6", scene_far_blob, true},
    {"half a blob at 9e6", scene_far_cut_blob, false},
    {"steep fog 1e6 m below", scene_steep_fog_far_below, false},
    {"soft fog 1e6 m below", scene_soft_fog_far_below, true},
    {"an orthographic picture 9e4 mean free paths high", scene_parallel_near, true},
    {"one of 1e5 from as far", scene_parallel_far, false},
};

static void test_invalid_input_is_refused(void **state)
{
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct test_scene test;
        char reason[256] = "";
        init_far(&test);
        cases[i].make(&test);
        const bool is_within = neph_is_in_float32_range(&test.scene, reason, sizeof(reason));
        if (is_within != cases[i].is_within)
            fail_msg("%s: %s", cases[i].name, is_within ? "not refused" : reason);
        assert_int_equal(is_within, reason[0] == '\0');
        assert_int_equal(is_within, neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason,
                                                          sizeof(reason)));
        assert_int_equal(is_within, neph_tracer_can_render(&test.scene, reason, sizeof(reason)));
        assert_true(is_within || strstr(reason, "float32"));
    }
}

/* --- just within range -------------------------------------------------------------------- */

/* Single scattering of sunlight by a half-space: E w p mu0 / (mu + mu0) (S. Chandrasekhar,
 * "Radiative Transfer", 1960, first order of diffuse reflection). */
static double half_space(const struct test_scene *test, struct neph_vec3 normal)
{
    const struct neph_medium *medium = &test->scene.media[0];
    const struct neph_vec3 sun = test->scene.sun.direction;
    const struct neph_vec3 view = neph_scene_camera(&test->scene, 0.0).forward;
    const double mu = -neph_vec3_dot(view, normal), mu0 = neph_vec3_dot(sun, normal);
    const double g = medium->phase.g;
    const double phase = (1.0 - g * g) /
                         (4.0 * M_PI * pow(1.0 + g * g - 2.0 * g * neph_vec3_dot(view, sun), 1.5));
    return test->scene.sun.irradiance_w_per_m2.r * medium->albedo.r * phase * mu0 / (mu + mu0);
}

static double mean_red(struct neph_image *frame)
{
    const double mean = test_mean(frame, "R");
    neph_image_destroy(frame);
    return mean;
}

/* The error of the mean in float32 was measured as 0.05 %. The tracer's noise over 1024 pixels of
 * 256 samples is 0.1 %; the error of the march's 65536 steps through 1000 mean free paths is
 * smaller. */
static void test_the_last_that_is_rendered_is_right(void **state)
{
    enum { SIDE_PX = 32 };
    struct test_scene test;
    init_far(&test);
    add_cube(&test, 1.0, 9e4, 500.0);
    const double expected = half_space(&test, (struct neph_vec3){0.0, 0.0, 1.0});
    const struct neph_tracer_params traced = {
        .width_px = SIDE_PX, .height_px = SIDE_PX, .samples = 256, .time_limit_s = INFINITY};
    neph_assert_close(mean_red(test_trace(*state, &test.scene, &traced, NULL)), expected, 4e-3,
                      0.0);
    const struct neph_march_params marched = {
        .width_px = SIDE_PX, .height_px = SIDE_PX, .steps = 8192, .sun_steps = 1};
    neph_assert_close(mean_red(test_march(*state, &test.scene, &marched, NULL)), expected, 4e-3,
                      0.0);
}

/* Sunlight from a half-space in pixels with rays that start up to 9e4 mean free paths from the
 * camera; noise and steps as above. */
static void test_largest_orthographic_frame_is_right(void **state)
{
    enum { WIDTH_PX = 48, HEIGHT_PX = 27 };
    struct test_scene test;
    init_far(&test);
    look_down_in_parallel(&test, 9e4);
    const double expected = half_space(&test, (struct neph_vec3){0.0, 1.0, 0.0});
    const struct neph_tracer_params traced = {
        .width_px = WIDTH_PX, .height_px = HEIGHT_PX, .samples = 256, .time_limit_s = INFINITY};
    neph_assert_close(mean_red(test_trace(*state, &test.scene, &traced, NULL)), expected, 4e-3,
                      0.0);
    const struct neph_march_params marched = {
        .width_px = WIDTH_PX, .height_px = HEIGHT_PX, .steps = 1024, .sun_steps = 1};
    neph_assert_close(mean_red(test_march(*state, &test.scene, &marched, NULL)), expected, 4e-3,
                      0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_float32_range.inc"
    };
    return cmocka_run_group_tests_name("reach", tests, test_vulkan_setup, test_vulkan_teardown);
}

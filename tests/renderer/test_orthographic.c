/* SPDX-License-Identifier: MIT
 *
 * Orthographic cameras. The ray marcher and the tracer are compared with exact transport along rays
 * that start on a plane. Each pixel equals the one of a perspective camera at the ray's origin that
 * looks along the ray. The real-time renderer finds its history along the wind.
 */
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/realtime_test.h"
#include "tests/renderer/verdict.h"

#include "scenes/motion.h"

enum { WIDTH = 16, HEIGHT = 9, PIXELS = WIDTH * HEIGHT };

static void init(struct test_scene *test, double height_m)
{
    test_scene_init(test);
    test->scene.vertical_fov_rad = 0.0;
    test->scene.orthographic_height_m = height_m;
}

/* --- scenes -------------------------------------------------------------------------------- */

static void scene_plume(struct test_scene *test)
{
    struct neph_medium *plume = test_add_cloud(test, NEPH_MEDIUM_PLUME, 1.2);
    plume->plume = (struct neph_plume){.foot_m = {-1.0, 0.0, -9.0},
                                       .axis = neph_vec3_normalize((struct neph_vec3){0.3, 1, 0.1}),
                                       .width_m = 0.9,
                                       .scale_height_m = 2.5};
}

/* From above the ground of a planet, upwards. */
static void scene_shell(struct test_scene *test)
{
    struct neph_medium *shell = test_add_cloud(test, NEPH_MEDIUM_SHELL, 2e-4);
    shell->shell = (struct neph_shell){{0.0, -6.371e6, 0.0}, 6.371e6, 8000.0};
    shell->bounds = (struct neph_bounds){{-3e6, -1e6, -3e6}, {3e6, 1.5e5, 3e6}};
    test->key.position_m = (struct neph_vec3){0.0, 3000.0, 0.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 3005.0, -10.0};
}

static void add_apart(struct test_scene *test, struct neph_medium medium, struct neph_vec3 at_m)
{
    const struct neph_vec3 half_m = {1.0, 1.0, 1.0};
    medium.bounds = (struct neph_bounds){neph_vec3_sub(at_m, half_m), neph_vec3_add(at_m, half_m)};
    test_add(test, medium);
}

/* A medium of each kind and a solid behind the camera and below, which no ray reaches: the scenes
 * then share one kernel, and compiling it is most of a test's time. */
static void add_shared_kernel_media(struct test_scene *test)
{
    const struct neph_vec3 at_m = neph_vec3_add(test->key.position_m,
                                                (struct neph_vec3){0.0, -500.0, 500.0});
    const struct neph_vec3 spacing_m = {0.5, 0.5, 0.5};
    uint64_t random = 12;
    struct neph_medium plume = make_medium(NEPH_MEDIUM_PLUME, 0.1), fog = make_height_fog(0.1, 0.1);
    fog.layers[0].height_m = at_m.y;
    plume.plume = (struct neph_plume){at_m, {0.0, 1.0, 0.0}, 1.0, 2.0};
    struct neph_grid *grid = random_lattice((const int[3]){2, 2, 2}, at_m, spacing_m, 0.5, &random);
    add_apart(test, make_homogeneous(0.1, everywhere), at_m);
    add_apart(test, fog, at_m);
    add_apart(test, make_shell(0.1, at_m, 0.2, 1.0), at_m);
    add_apart(test, make_blob(0.1, at_m, 1.0), at_m);
    add_apart(test, plume, at_m);
    add_apart(test, make_voxels(0.1, grid), at_m);
    test_add_sphere(test, at_m, 0.1); /* might shadow them */
}

static const struct {
    const char *name;
    void (*build)(struct test_scene *);
    double height_m, order_min; /* of convergence in the steps; lower where a density has kinks */
} scenes[] = {
    {"cube", scene_cube, 5.0, 1.8},
    {"fog, down", scene_fog_down, 60.0, 1.8},
    {"layers, up", scene_two_layers_up, 12.0, 1.8},
    {"shell", scene_shell, 5000.0, 1.8},
    {"plume", scene_plume, 8.0, 1.8},
    {"Gaussian", scene_blob, 8.0, 1.8},
    {"grid", scene_voxels, 7.0, 1.5},
};

/* --- the march against exact transport ---------------------------------------------------- */

struct difference {
    double transmittance, volume; /* largest differences; volume relative to the largest radiance */
};

static struct difference measure_difference(const struct test_scene *test, struct neph_image *frame)
{
    struct difference worst = {0.0, 0.0};
    double brightest = 0.0;
    const float *transmittance = neph_image_channel(frame, "transmittance.G");
    const float *volume = neph_image_channel(frame, "volume.G");
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_ray_light light = test_exact_ray(&test->scene, WIDTH, HEIGHT, p);
        worst.transmittance = fmax(worst.transmittance,
                                   fabs((double)transmittance[p] - light.transmittance.g));
        worst.volume = fmax(worst.volume, fabs((double)volume[p] - light.volume.g));
        brightest = fmax(brightest, light.volume.g);
    }
    worst.volume /= brightest;
    neph_image_destroy(frame);
    return worst;
}

/* As for perspective cameras (test_march_media.c, test_march.c): transmittance has float32
 * precision, in-scattering converges with the square of the step, down to some 1e-6. */
static void test_march_is_exact_transport(void **state)
{
    for (size_t s = 0; s < COUNT(scenes); s += (size_t)neph_test_by_day(3, 1)) {
        OWNED(media) struct test_scene test;
        struct neph_march_params params = {.width_px = WIDTH, .height_px = HEIGHT, .steps = 64};
        init(&test, scenes[s].height_m);
        scenes[s].build(&test);
        add_shared_kernel_media(&test);
        const struct difference coarse = measure_difference(
            &test, test_march(*state, &test.scene, &params, NULL));
        params.steps = 256;
        const struct difference fine = measure_difference(
            &test, test_march(*state, &test.scene, &params, NULL));
        const double order = log2(coarse.volume / fine.volume) / 2.0;
        print_message("%-12s T off by %.1e; volume by %.1e, %.1e: order %.2f\n", scenes[s].name,
                      fine.transmittance, coarse.volume, fine.volume, order);
        assert_true(fine.transmittance < 3e-6 && fine.volume < 5e-3);
        assert_true(fine.volume < 2e-6 || order > scenes[s].order_min);
    }
}

/* Sunlit surfaces through fog, and Z. A ray that grazes a solid or a shadow edge may be on either
 * side of it. */
static void test_solids(void **state)
{
    struct test_scene test;
    const struct neph_march_params params = {.width_px = WIDTH, .height_px = HEIGHT, .steps = 1};
    int agreeing = 0;
    init(&test, 12.0);
    scene_yard(&test);
    test.key.position_m = (struct neph_vec3){1.0, 9.0, 4.0};
    test.key.look_at_m = (struct neph_vec3){0.0, 1.0, -14.0};
    add_shared_kernel_media(&test);
    test.scene.scattering = NEPH_SCATTERING_NONE;
    OWNED(image) struct neph_image *frame = test_march(*state, &test.scene, &params, NULL);
    const float *green = neph_image_channel(frame, "G"), *z_m = neph_image_channel(frame, "Z");
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_ray_light light = test_exact_ray(&test.scene, WIDTH, HEIGHT, p);
        const bool same_depth = isinf(light.hit_m)
                                    ? isinf(z_m[p])
                                    : fabs((double)z_m[p] - light.hit_m) <= 1e-5 * light.hit_m;
        const double off = fabs((double)green[p] - light.radiance.g);
        agreeing += same_depth && off <= 2e-5 * light.radiance.g + 1e-6;
    }
    print_message("solids: %d of %d pixels agree\n", agreeing, PIXELS);
    assert_true(agreeing >= PIXELS - 1);
}

/* --- each pixel equals a perspective camera's --------------------------------------------- */

static void scene_horizon(struct test_scene *test)
{
    struct neph_horizon_params params = neph_horizon_defaults();
    struct neph_diag diag = {0};
    struct neph_medium *layer = test_add_cloud(test, NEPH_MEDIUM_HORIZON, 0.02);
    params.bottom_m = 80.0;
    params.thickness_m = 280.0;
    params.coverage = 0.9;
    neph_assert_ok(neph_horizon_create(&params, &layer->horizon, &diag), &diag);
    layer->bounds = (struct neph_bounds){{-600, 60, -1200}, {600, 400, 0}};
    test->key.look_at_m = (struct neph_vec3){0.0, 6.0, -10.0};
}

static void scene_grid_in_fog(struct test_scene *test)
{
    scene_voxels(test);
    scene_fog(test);
    test_add_box(test, (struct neph_vec3){-50, -3, -50}, (struct neph_vec3){50, -1.2, 50});
}

static void scene_grid_in_company(struct test_scene *test)
{
    scene_grid_in_fog(test);
    add_shared_kernel_media(test);
}

/* Far from the world's origin. Both cameras compute positions relative to it. */
static void scene_far_away(struct test_scene *test)
{
    scene_far_from_the_origin(test);
    add_shared_kernel_media(test);
}

static const struct {
    const char *name;
    void (*build)(struct test_scene *);
    double height_m;
    enum neph_march_lighting lighting;
    double relative; /* float32 positions differ; clamped noise of clouds amplifies that */
} lights[] = {
    {"single, grid in fog", scene_grid_in_company, 7.0, NEPH_MARCH_SINGLE, 2e-5},
    {"single, far away", scene_far_away, 10.0, NEPH_MARCH_SINGLE, 2e-5},
    {"octaves, grid in fog", scene_grid_in_fog, 7.0, NEPH_MARCH_OCTAVES, 2e-5},
    {"horizon, clouds", scene_horizon, 300.0, NEPH_MARCH_HORIZON, 2e-3},
};

static struct neph_image *march_alone(struct neph_vulkan *vulkan, const struct test_scene *test,
                                      const struct neph_march_params *params, int pixel)
{
    const struct neph_pixel_ray ray = test_ray(&test->scene, params->width_px, params->height_px,
                                               pixel);
    struct test_scene other = *test;
    struct neph_march_params one = *params;
    other.scene.camera_keys = &other.key;
    other.scene.orthographic_height_m = 0.0;
    other.scene.vertical_fov_rad = 0.5;
    other.key.position_m = ray.origin_m;
    other.key.look_at_m = neph_vec3_along(ray.origin_m, ray.direction, 10.0);
    one.width_px = one.height_px = 1;
    return test_march(vulkan, &other.scene, &one, NULL);
}

static void test_every_pixel_is_a_perspective_cameras(void **state)
{
    for (size_t l = 0; l < COUNT(lights); l += (size_t)neph_test_by_day(3, 1)) {
        OWNED(media) struct test_scene test;
        const struct neph_march_params params = {.width_px = 6,
                                                 .height_px = 4,
                                                 .steps = 48,
                                                 .sun_steps = 8,
                                                 .lighting = lights[l].lighting};
        double least = INFINITY, most = 0.0;
        init(&test, lights[l].height_m);
        lights[l].build(&test);
        test.scene.scattering = lights[l].lighting == NEPH_MARCH_SINGLE ? NEPH_SCATTERING_SINGLE
                                                                        : NEPH_SCATTERING_MULTIPLE;
        test.scene.octaves = (struct neph_octaves){4, 0.5, 0.5, 0.5};
        OWNED(image) struct neph_image *frame = test_march(*state, &test.scene, &params, NULL);
        for (int p = 0; p < 24; p++) {
            OWNED(image) struct neph_image *alone = march_alone(*state, &test, &params, p);
            for (int c = 0; c < frame->channel_count; c++)
                neph_assert_close((double)frame->channels[c].samples[p],
                                  (double)alone->channels[c].samples[0], lights[l].relative, 1e-6);
            least = fmin(least, (double)frame->channels[0].samples[p]);
            most = fmax(most, (double)frame->channels[0].samples[p]);
        }
        print_message("%s: %g to %g\n", lights[l].name, least, most);
        assert_true(most > 1.05 * least); /* the pixels differ */
    }
}

/* --- the tracer ----------------------------------------------------------------------------- */

/* Free paths of each kind: by bisection, through voxels, in layers. */
static void test_tracer_is_exact_transport(void **state)
{
    OWNED(media) struct test_scene test;
    init(&test, 7.0);
    scene_voxels(&test);
    scene_fog(&test);
    scene_blob(&test);
    const struct neph_tracer_params params = test_samples(WIDTH, HEIGHT, 20261123, 256);
    OWNED(image) struct neph_image *frame = test_trace(*state, &test.scene, &params, NULL);
    judge("blob, grid and fog", compare(&test, frame, exact_single, NULL), 2.0 / 32.0);
}

/* --- the real-time renderer ---------------------------------------------------------------- */

enum { FILM_WIDTH = 64, FILM_HEIGHT = 36, FILM_FRAMES = 12 };

static struct neph_image *film_truth(struct neph_vulkan *vulkan, const struct test_scene *test,
                                     const struct neph_settings *settings)
{
    const struct neph_march_params params = {
        .width_px = FILM_WIDTH,
        .height_px = FILM_HEIGHT,
        .frame = FILM_FRAMES - 1,
        .steps = (int)settings->values[RT_STEPS],
        .transmittance = (enum neph_march_mode)(int)settings->values[RT_TRANSMITTANCE],
        .sun = (enum neph_march_mode)(int)settings->values[RT_SUN],
        .sun_steps = (int)settings->values[RT_SUN_STEPS]};
    OWNED(scene) struct neph_scene *still = test_still(&test->scene, params.frame);
    return test_march(vulkan, still, &params, NULL);
}

/* Largest error of the last frame, relative to the brightest pixel. */
static double film_error(struct neph_vulkan *vulkan, const struct test_scene *test,
                         const char *assignments)
{
    const struct neph_settings settings = test_settings(assignments);
    const struct neph_realtime_params params = {FILM_WIDTH, FILM_HEIGHT, &settings, 7, NULL};
    OWNED(image)
    struct neph_image *film = test_film(vulkan, &test->scene, &params, FILM_FRAMES, NULL);
    OWNED(image) struct neph_image *truth = film_truth(vulkan, test, &settings);
    const float *found = neph_image_channel(film, "volume.G");
    const float *expected = neph_image_channel(truth, "volume.G");
    double most = 0.0, worst = 0.0;
    for (size_t i = 0; i < neph_image_pixel_count(film); i++) {
        most = fmax(most, (double)expected[i]);
        worst = fmax(worst, fabs((double)found[i] - (double)expected[i]));
    }
    return worst / most;
}

/* With the split frame a drifting blob has the same error as one of the same size under a
 * perspective camera, within a tenth, by which near and far side differ in scale. A history that
 * does not follow the wind has twice the error. */
static void test_history_drifts_with_the_wind(void **state)
{
    static const char following[] = "taa=off ray_dither=none upscale_dither=none";
    struct neph_wind_key wind = {0.0, {-6.0, 0.0, 0.0}};
    struct test_scene test;
    init(&test, 8.0);
    scene_blob(&test);
    test.scene.frame_count = FILM_FRAMES;
    test.scene.wind_keys = &wind;
    test.scene.wind_key_count = 1;
    const double parallel = film_error(*state, &test, following);
    if (neph_test_is_night()) /* needs other kernels */
        assert_true(
            film_error(*state, &test, "taa=off ray_dither=none upscale_dither=none wind=off") >
            1.2 * parallel);
    test.scene.orthographic_height_m = 0.0;
    test.scene.vertical_fov_rad = 2.0 * atan(4.0 / 12.0);
    const double perspective = film_error(*state, &test, following);
    print_message("realtime: off by %.2g; in perspective %.2g\n", parallel, perspective);
    assert_true(parallel < 1.2 * perspective);
    assert_true(perspective < 0.16); /* measured: 0.10; 0.24 without following the wind */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_orthographic.inc"
    };
    return cmocka_run_group_tests_name("orthographic", tests, test_vulkan_setup,
                                       test_vulkan_teardown);
}

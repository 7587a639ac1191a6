/* SPDX-License-Identifier: MIT
 *
 * Approximations of the ray marcher: each one off keeps the bits, each one on has an effect, and
 * its error is within its bound.
 */
#include "tests/renderer/frames.h"

#include "renderer/sun_cache.h"
#include "scenes/media.h"

#include <stdlib.h>

enum { WIDTH_PX = 40, HEIGHT_PX = 24, PIXELS = WIDTH_PX * HEIGHT_PX };

static const struct neph_march_params marched = {.width_px = WIDTH_PX,
                                                 .height_px = HEIGHT_PX,
                                                 .steps = 64,
                                                 .transmittance = NEPH_MARCH_MARCHED,
                                                 .sun = NEPH_MARCH_MARCHED,
                                                 .sun_steps = 6};

/* --- scenes --------------------------------------------------------------------------------- */

static const double blob_per_m = 0.8, blob_width_m = 1.5, blob_reach_m = 4.5;

/* Cut at three widths. */
static void add_blob(struct test_scene *test)
{
    const struct neph_vec3 at_m = {0.5, 2.0, -12.0};
    struct neph_medium *blob = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, blob_per_m);
    const struct neph_vec3 reach_m = {blob_reach_m, blob_reach_m, blob_reach_m};
    blob->gaussian = (struct neph_gaussian){at_m, blob_width_m};
    blob->bounds = (struct neph_bounds){neph_vec3_sub(at_m, reach_m), neph_vec3_add(at_m, reach_m)};
}

/* Most of its nodes are 0. */
static void add_sparse_grid(struct test_scene *test)
{
    uint64_t random = 11;
    test_add_cloud(test, NEPH_MEDIUM_GRID, 0.9)->grid = random_lattice(
        (const int[3]){12, 11, 10}, (struct neph_vec3){-3.0, -1.0, -15.0},
        (struct neph_vec3){0.6, 0.5, 0.7}, -9.0, &random);
}

/* Tests that need some grid use two, so that they share a kernel; compiling it is most of their
 * time. */
static void add_two_grids(struct test_scene *test)
{
    add_sparse_grid(test);
    add_sparse_grid(test);
    neph_medium_drift(&test->scene.media[1], (struct neph_vec3){1.1, 0.4, -3.0});
}

static void add_fog(struct test_scene *test)
{
    test_add_medium(test, 0.03, 0.05, 0.0);
}

static void add_ground(struct test_scene *test)
{
    test_add_box(test, (struct neph_vec3){-1e3, -3.0, -1e3}, (struct neph_vec3){1e3, -2.0, 1e3});
}

/* --- off ------------------------------------------------------------------------------------ */

static void assert_same_with(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                             struct neph_march_params params, struct neph_shortcuts shortcuts)
{
    OWNED(image) struct neph_image *plain = test_march(vulkan, scene, &params, NULL);
    params.shortcuts = shortcuts;
    OWNED(image) struct neph_image *short_cut = test_march(vulkan, scene, &params, NULL);
    assert_true(test_same_bits(plain, short_cut));
}

static void test_disabled_values_are_ignored(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, add_two_grids);
    assert_same_with(*state, &test.scene, marched,
                     (struct neph_shortcuts){.sun_cache_voxels = 77, .step_growth = 1.0});
}

/* --- skipping ------------------------------------------------------------------------------- */

static void check_skip(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                       struct neph_march_params params, const char *what)
{
    struct neph_march_stats every, some;
    OWNED(image) struct neph_image *plain = test_march(vulkan, scene, &params, &every);
    params.shortcuts.skip = true;
    OWNED(image) struct neph_image *skipped = test_march(vulkan, scene, &params, &some);
    print_message("%s: %llu density evaluations, then %llu\n", what,
                  (unsigned long long)every.density_evaluations,
                  (unsigned long long)some.density_evaluations);
    assert_true(test_same_bits(plain, skipped));
    assert_true(some.density_evaluations > 0);
    assert_true(some.density_evaluations < every.density_evaluations);
}

static void test_skipping_keeps_the_bits(void **state)
{
    OWNED(media) struct test_scene two, test;
    test_scene_build(&two, add_two_grids);
    add_ground(&two);
    check_skip(*state, &two.scene, marched, "sparse grids");
    test_scene_build(&test, add_sparse_grid);
    add_ground(&test);
    struct neph_march_params params = marched;
    params.transmittance = params.sun = NEPH_MARCH_EXACT;
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.7, 0.4};
    check_skip(*state, &test.scene, params, "coloured, with closed forms");
}

/* In fog every step counts; only the cloud's density is not sampled in empty cells, which no
 * counter shows. */
static void test_skipping_in_fog_keeps_the_bits(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, add_sparse_grid);
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.7, 0.4};
    add_fog(&test);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    struct neph_march_params params = marched;
    params.lighting = NEPH_MARCH_OCTAVES;
    assert_same_with(*state, &test.scene, params, (struct neph_shortcuts){.skip = true});
}

/* --- the slab ------------------------------------------------------------------------------- */

static struct neph_medium *add_slab(struct test_scene *test, double extinction_per_m)
{
    struct neph_medium *slab = test_add_medium(test, extinction_per_m, 0.0, 0.0);
    slab->bounds = (struct neph_bounds){{-20.0, -20.0, -30.0}, {20.0, 20.0, -5.0}};
    return slab;
}

/* With fog only there is nothing to skip or to cache. */
static void test_only_fog_keeps_the_bits(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_slab(&test, 0.2);
    assert_same_with(
        *state, &test.scene, marched,
        (struct neph_shortcuts){.skip = true, .sun_cache = true, .sun_cache_voxels = 32});
}

/* --- the sun cache -------------------------------------------------------------------------- */

static struct neph_march_params cached(int voxels)
{
    return (struct neph_march_params){.width_px = WIDTH_PX,
                                      .height_px = HEIGHT_PX,
                                      .steps = 64,
                                      .shortcuts = {.sun_cache = true, .sun_cache_voxels = voxels}};
}

static double cache_error(struct neph_vulkan *vulkan, const struct neph_scene *scene, int voxels)
{
    struct neph_march_params params = cached(voxels);
    OWNED(image) struct neph_image *with = test_march(vulkan, scene, &params, NULL);
    params.shortcuts.sun_cache = false;
    OWNED(image) struct neph_image *without = test_march(vulkan, scene, &params, NULL);
    return test_largest_difference(with, without, "volume");
}

/* Bound of the interpolation error at a node distance h: h^2 / 8 times the sum of the second
 * derivatives of the depth along the axes. For a Gaussian they are at most s sqrt(2 pi) / w across
 * the sun's direction and s e^-0.5 / w along it: together 3.2 s / w, and three times that for all
 * axes. The radiance error is at most that times the sun's irradiance and the largest phase
 * function. */
static double cache_bound(const struct neph_scene *scene, int voxels)
{
    const double spacing_m = 2.0 * blob_reach_m / (voxels - 1);
    const double depth = spacing_m * spacing_m / 8.0 * 3.0 * 3.2 * blob_per_m / blob_width_m;
    const double g = scene->media[0].phase.g;
    const double phase_per_sr = (1.0 + g) / (4.0 * M_PI * (1.0 - g) * (1.0 - g));
    return depth * scene->sun.irradiance_w_per_m2.r * phase_per_sr;
}

static void check_cache(struct neph_vulkan *vulkan, const struct neph_scene *scene)
{
    double before = INFINITY;
    for (int voxels = 9; voxels <= 33; voxels = 2 * voxels - 1) {
        const double error = cache_error(vulkan, scene, voxels);
        print_message("%d nodes: volume off by %.2e, at most %.2e\n", voxels, error,
                      cache_bound(scene, voxels));
        assert_true(error > 0.0 && error < cache_bound(scene, voxels));
        assert_true(error < before / 2.5); /* 4 for vanishing higher derivatives */
        before = error;
    }
}

static void test_the_sun_cache_is_of_second_order(void **state)
{
    struct test_scene test;
    test_scene_build(&test, add_blob);
    check_cache(*state, &test.scene);
}

/* A coloured cloud has three depths per node; red's is the largest here. Fog is in front of it, and
 * in its shadow. */
static void test_the_sun_cache_has_colours(void **state)
{
    struct test_scene test;
    test_scene_build(&test, add_blob);
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.5, 0.1};
    add_fog(&test);
    check_cache(*state, &test.scene);
}

static size_t cache_bytes(struct neph_vulkan *vulkan, const struct neph_scene *scene)
{
    const struct neph_march_params params = cached(9);
    struct neph_gpu_scene gpu = {.frame = NULL};
    struct neph_sun_cache cache = {.vulkan = NULL};
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_gpu_scene_create(vulkan, scene, 0.0, WIDTH_PX, HEIGHT_PX, false, &gpu, &diag), &diag);
    neph_assert_ok(neph_sun_cache_create(vulkan, scene, &gpu, &params, 0, &cache, &diag), &diag);
    const size_t bytes = cache.nodes.size_bytes;
    neph_sun_cache_destroy(&cache);
    neph_gpu_scene_destroy(vulkan, &gpu);
    return bytes;
}

/* A node has three depths only for coloured media, not for other properties of a scene. */
static void test_the_sun_cache_has_a_depth_a_channel(void **state)
{
    enum { NODES = 9 * 9 * 9 };
    struct test_scene test;
    test_scene_build(&test, add_blob);
    assert_int_equal(cache_bytes(*state, &test.scene), NODES * sizeof(float));
    test.scene.vertical_fov_rad = 0.0;
    test.scene.orthographic_height_m = 10.0;
    assert_int_equal(cache_bytes(*state, &test.scene), NODES * sizeof(float));
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.5, 0.1};
    assert_int_equal(cache_bytes(*state, &test.scene), 3 * NODES * sizeof(float));
}

/* Filled once, and again when the sun or the cloud has moved, with the result of a new cache. */
static void check_refill(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                         struct neph_march *march, uint64_t *fill_evaluations)
{
    struct neph_march_params params = cached(32);
    params.sun = NEPH_MARCH_MARCHED;
    params.sun_steps = 6;
    struct neph_march_stats first, again;
    OWNED(image) struct neph_image *moved = test_march_next(march, scene, &first);
    OWNED(image) struct neph_image *still = test_march_next(march, scene, &again);
    OWNED(image) struct neph_image *alone = test_march(vulkan, scene, &params, NULL);
    assert_true(test_same_bits(moved, still) && test_same_bits(moved, alone));
    *fill_evaluations = first.density_evaluations - again.density_evaluations;
}

static void test_the_sun_cache_follows_sun_and_cloud(void **state)
{
    struct test_scene test;
    uint64_t evaluations;
    test_scene_build(&test, add_blob);
    struct neph_march_params params = cached(32);
    params.sun = NEPH_MARCH_MARCHED;
    params.sun_steps = 6;
    OWNED(march) struct neph_march *march = test_march_open(*state, &test.scene, &params);
    check_refill(*state, &test.scene, march, &evaluations);
    /* Six per node, except for nodes at which the sun ray leaves the bounds at once. */
    assert_true(evaluations > 6 * 31 * 31 * 31 * 9 / 10 && evaluations <= 6 * 32 * 32 * 32);
    test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){-0.5, 0.7, -0.6});
    check_refill(*state, &test.scene, march, &evaluations);
    assert_true(evaluations > 0);
    neph_medium_drift(&test.scene.media[0], (struct neph_vec3){0.25, 0.0, 0.5});
    check_refill(*state, &test.scene, march, &evaluations);
    assert_true(evaluations > 0);
}

/* Refilled over several frames: an existing cache is used at once, and a part is renewed in each
 * frame. */
static void test_sun_cache_refills_over_frames(void **state)
{
    enum { PICTURES = 4 };
    struct test_scene test;
    test_scene_build(&test, add_blob);
    struct neph_march_params params = cached(32);
    params.sun = NEPH_MARCH_MARCHED;
    params.sun_steps = 6;
    OWNED(image) struct neph_image *before = test_march(*state, &test.scene, &params, NULL);
    params.shortcuts.sun_cache_frames = PICTURES;
    OWNED(march) struct neph_march *march = test_march_open(*state, &test.scene, &params);
    struct neph_march_stats whole, rest, stats;
    OWNED(image) struct neph_image *first = test_march_next(march, &test.scene, &whole);
    OWNED(image) struct neph_image *still = test_march_next(march, &test.scene, &rest);
    assert_true(test_same_bits(first, before) && test_same_bits(still, before));

    test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){-0.5, 0.7, -0.6});
    OWNED(image) struct neph_image *after = test_march(*state, &test.scene, &params, NULL);
    assert_false(test_same_bits(after, before));
    uint64_t filled = 0;
    for (int picture = 1; picture <= PICTURES + 1; picture++) {
        OWNED(image) struct neph_image *image = test_march_next(march, &test.scene, &stats);
        const uint64_t evaluations = stats.density_evaluations - rest.density_evaluations;
        assert_int_equal(test_same_bits(image, after), picture >= PICTURES);
        assert_int_equal(evaluations > 0, picture <= PICTURES);
        filled += evaluations;
    }
    struct neph_march_stats alone;
    neph_image_destroy(test_march(*state, &test.scene, &params, &alone));
    assert_int_equal(filled, alone.density_evaluations - rest.density_evaluations);
}

/* --- early out ------------------------------------------------------------------------------ */

/* The omitted part has a transmittance below the limit, times the largest single scattering and the
 * background. */
static void test_early_out_error_is_below_its_limit(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    const struct neph_medium *slab = add_slab(&test, 0.9);
    const double limits[] = {0.01, 0.1};
    const double g = slab->phase.g;
    const double phase_per_sr = (1.0 + g) / (4.0 * M_PI * (1.0 - g) * (1.0 - g));
    const double brightest = 10.0 * phase_per_sr + 0.4;
    struct neph_march_params params = marched;
    struct neph_march_stats whole, ended;
    OWNED(image) struct neph_image *plain = test_march(*state, &test.scene, &params, &whole);
    for (int i = 0; i < 2; i++) {
        params.shortcuts.early_out = limits[i];
        OWNED(image) struct neph_image *early = test_march(*state, &test.scene, &params, &ended);
        const double error = test_largest_difference(plain, early, NULL);
        print_message("early_out %g: off by %.2e, %llu of %llu steps\n", limits[i], error,
                      (unsigned long long)ended.view_steps, (unsigned long long)whole.view_steps);
        assert_true(error > 0.0 && error < limits[i] * brightest);
        assert_true(test_largest_difference(plain, early, "transmittance") < limits[i]);
        assert_true(ended.view_steps < whole.view_steps / 2);
        assert_true(ended.density_evaluations < whole.density_evaluations / 2);
    }
}

/* --- growing steps -------------------------------------------------------------------------- */

static double growth_difference(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                int steps, double growth, const char *layer)
{
    struct neph_march_params params = marched;
    params.steps = steps;
    OWNED(image) struct neph_image *equal = test_march(vulkan, scene, &params, NULL);
    params.shortcuts.step_growth = growth;
    OWNED(image) struct neph_image *grown = test_march(vulkan, scene, &params, NULL);
    return test_largest_difference(equal, grown, layer);
}

/* Growing steps cover the ray, and converge to the same result. */
static void test_growing_steps_tile_the_ray(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_slab(&test, 0.2);
    /* pow() is accurate to 16 ulp at a largest power of 20, and edges to 1e-6 of 25 m. */
    assert_true(growth_difference(*state, &test.scene, 64, 1.05, "transmittance") < 3e-6);
    const double coarse = growth_difference(*state, &test.scene, 16, 1.2, "volume");
    const double fine = growth_difference(*state, &test.scene, 64, pow(1.2, 0.25), "volume");
    print_message("growing steps: volume off by %.2e, with four times as many %.2e\n", coarse,
                  fine);
    assert_true(coarse > 1e-5 && fine < coarse / 8.0); /* 16 for a second-order step error */
}

/* --- joined steps --------------------------------------------------------------------------- */

static double depth_growth_difference(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      struct neph_march_params params, uint64_t steps[2])
{
    struct neph_march_stats every, some;
    params.shortcuts.depth_growth = 0.0;
    OWNED(image) struct neph_image *equal = test_march(vulkan, scene, &params, &every);
    params.shortcuts.depth_growth = 4.0;
    OWNED(image) struct neph_image *grown = test_march(vulkan, scene, &params, &some);
    const double difference = test_largest_difference(equal, grown, "volume");
    /* The transmittance covers the whole medium, for steps of any length. */
    assert_true(test_largest_difference(equal, grown, "transmittance") < 3e-6);
    steps[0] = every.view_steps;
    steps[1] = some.view_steps;
    return difference;
}

/* Joined steps cover the ray, are fewer, and converge to the same result: a step is at most 16
 * times as long. */
static void test_steps_grow_by_depth(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_slab(&test, 0.2);
    struct neph_march_params params = marched;
    uint64_t steps[2];
    params.steps = 64;
    const double coarse = depth_growth_difference(*state, &test.scene, params, steps);
    assert_true(steps[1] < steps[0] / 2 && steps[1] > steps[0] / 16);
    params.steps = 256;
    const double fine = depth_growth_difference(*state, &test.scene, params, steps);
    print_message("steps that grow by depth: volume off by %.2e, with four times as many %.2e\n",
                  coarse, fine);
    assert_true(coarse > 1e-5 && fine < coarse / 8.0); /* 16 for a second-order step error */
}

/* Where no optical depth reaches 1 / depth_growth, the steps are unchanged, up to the order of
 * sums: clear steps are passed in another loop. */
static void test_steps_in_thin_media_do_not_grow(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, add_sparse_grid);
    struct neph_march_params params = marched;
    params.shortcuts.depth_growth = 1e-6;
    struct neph_march_stats plain, thin;
    OWNED(image) struct neph_image *grown = test_march(*state, &test.scene, &params, &thin);
    params.shortcuts.depth_growth = 0.0;
    OWNED(image) struct neph_image *equal = test_march(*state, &test.scene, &params, &plain);
    assert_int_equal(thin.density_evaluations, plain.density_evaluations);
    assert_true(test_largest_difference(equal, grown, "volume") < 1e-6);
}

/* --- refusals ------------------------------------------------------------------------------- */

static void test_useless_options_are_refused(void **state)
{
    static const struct {
        struct neph_shortcuts shortcuts;
        enum neph_march_lighting lighting;
        enum neph_status status;
    } cases[] = {
        {{.step_growth = 1.2}, NEPH_MARCH_SINGLE, NEPH_OK},
        {{.step_growth = 1.3}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.step_growth = 1.0005}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.depth_growth = 17.0}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.depth_growth = -1.0}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.early_out = 1.5}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.sun_cache = true, .sun_cache_voxels = 7}, NEPH_MARCH_SINGLE, NEPH_ERR_USAGE},
        {{.skip = true}, NEPH_MARCH_HORIZON, NEPH_ERR_UNSUPPORTED},
        {{.sun_cache = true, .sun_cache_voxels = 64}, NEPH_MARCH_HORIZON, NEPH_ERR_UNSUPPORTED},
    };
    struct test_scene test;
    test_scene_build(&test, add_blob);
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_march_params params = marched;
        struct neph_diag diag = {0};
        params.shortcuts = cases[i].shortcuts;
        params.lighting = cases[i].lighting;
        assert_int_equal(neph_march_check(&test.scene, &params, &diag), cases[i].status);
    }
}

/* Two clouds, one of them moving: empty cells do not stay empty. With both moving together they
 * do. */
static void test_skipping_refuses_media_that_part(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    const struct neph_vec3 by_m = {0.25, 0.0, 0.5};
    test_scene_build(&test, add_two_grids);
    struct neph_march_params params = marched;
    params.shortcuts.skip = true;
    OWNED(march) struct neph_march *march = test_march_open(*state, &test.scene, &params);
    for (int m = 0; m < 2; m++)
        neph_medium_drift(&test.scene.media[m], by_m);
    OWNED(image) struct neph_image *together = test_march_next(march, &test.scene, NULL);
    params.shortcuts.skip = false;
    OWNED(image) struct neph_image *plain = test_march(*state, &test.scene, &params, NULL);
    assert_true(test_same_bits(plain, together));
    neph_medium_drift(&test.scene.media[0], by_m);
    assert_int_equal(neph_march_frame(march, &test.scene, 0.0, NULL, &frame, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
}

/* --- in real time --------------------------------------------------------------------------- */

/* The second of two frames. By day of the march itself, with kernels that exist already; at night
 * of the split frame. */
static struct neph_image *second_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const char *assignments, struct neph_realtime_stats *stats)
{
    struct neph_settings settings = test_preset(NULL, assignments);
    if (!neph_test_is_night())
        settings.values[RT_SPLIT] = RT_SPLIT_NONE;
    const struct neph_realtime_params params = {WIDTH_PX, HEIGHT_PX, &settings, 7, NULL};
    return test_film(vulkan, scene, &params, 2, stats);
}

static void test_shortcuts_in_real_time(void **state)
{
    static const char plain[] = "transmittance=marched sun=marched sun_steps=6 taa=off "
                                "ray_dither=none upscale_dither=none";
    static const char all[] = "transmittance=marched sun=marched sun_steps=6 taa=off "
                              "ray_dither=none upscale_dither=none skip=majorant sun_cache=grid "
                              "sun_cache_voxels=32";
    OWNED(media) struct test_scene test;
    struct neph_realtime_stats stats[2];
    test_scene_build(&test, add_sparse_grid);
    OWNED(image) struct neph_image *slow = second_frame(*state, &test.scene, plain, &stats[0]);
    OWNED(image) struct neph_image *fast = second_frame(*state, &test.scene, all, &stats[1]);
    assert_false(test_same_bits(slow, fast));
    assert_true(stats[1].view_steps < stats[0].view_steps);
    /* The grid exists already: one evaluation per step remains. */
    assert_int_equal(stats[1].density_evaluations, stats[1].view_steps);
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Voxel grids through the texture unit: value by value within the precision of weights and texels,
 * and in a march, where only these values change.
 */
#include "tests/renderer/frames.h"
#include "tests/renderer/probe.h"

#include "renderer/grid_textures.h"
#include "renderer/march_split.h"
#include "renderer/texture.h"
#include "renderer/vulkan_device.h"
#include "scenes/grid.h"
#include "scenes/media.h"

#include <stdlib.h>

static const uint32_t probe_code[] = {
#include "shaders/probe_texture.comp.inc"
};

enum { WIDTH_PX = 24, HEIGHT_PX = 16, POINTS = 1500 };

/* Two grids with six different sides, one of them with fine voxels. */
static void add_grids(struct test_scene *test)
{
    static const struct neph_vec3 spacings_m[2] = {{0.6, 0.5, 0.7}, {0.3, 0.25, 0.4}};
    uint64_t random = 11;
    for (int i = 0; i < 2; i++)
        test_add_cloud(test, NEPH_MEDIUM_GRID, 0.9 + i)->grid = random_lattice(
            (const int[3]){12 + i, 11, 10}, (struct neph_vec3){-3.0 + 4.0 * i, -1.0, -15.0},
            spacings_m[i], -2.0, &random);
}

/* --- values ----------------------------------------------------------------------------------- */

struct point {
    float at_m[3], medium;
};

/* Points in cells, on nodes (also of the layer of zeros), and outside. */
static void choose_points(const struct test_scene *test, struct point points[POINTS])
{
    uint64_t random = 5;
    for (int i = 0; i < POINTS; i++) {
        const struct neph_grid *grid = test->scene.media[i % 2].grid;
        const struct neph_vec3 low_m = neph_vec3_sub(grid->origin_m, test->key.position_m);
        const double lows_m[3] = {low_m.x, low_m.y, low_m.z};
        const double steps_m[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
        points[i].medium = (float)(i % 2);
        for (int axis = 0; axis < 3; axis++) {
            const double place = neph_test_uniform(&random, -1.5, grid->size[axis] + 0.5);
            points[i].at_m[axis] = (float)(lows_m[axis] +
                                           (i % 5 == 0 ? floor(place) : place) * steps_m[axis]);
        }
    }
}

/* The caller frees the result. */
static float *ask(struct neph_vulkan *vulkan, const struct test_scene *test,
                  const struct point points[POINTS], const struct neph_shortcuts *shortcuts)
{
    struct neph_diag diag = {0};
    struct neph_gpu_scene gpu = {0};
    neph_assert_ok(neph_gpu_scene_create(vulkan, &test->scene, 0.0, 8, 8, false, &gpu, &diag),
                   &diag);
    neph_assert_ok(neph_grid_textures_create(vulkan, &test->scene, shortcuts, &gpu, &diag), &diag);
    struct neph_kernel_params params = {
        .name = "probe_texture",
        .code = probe_code,
        .code_bytes = sizeof(probe_code),
        .buffer_count = NEPH_GPU_SCENE_BUFFERS + 2,
        .uniform_count = NEPH_GPU_SCENE_UNIFORMS,
        .image_count = NEPH_GPU_MEDIA_MAX,
        .constant_count = NEPH_MARCH_CONSTANTS,
    };
    neph_march_constants(&gpu, &(struct neph_march_params){.shortcuts = *shortcuts},
                         params.constants);
    float *answers = test_probe(vulkan, &params, &gpu, points, sizeof(*points), sizeof(*answers),
                                POINTS);
    neph_gpu_scene_destroy(vulkan, &gpu);
    return answers;
}

/* Range of the eight nodes around a point. */
static double spread_around(const struct neph_grid *grid, struct neph_vec3 at_m)
{
    const double places[3] = {(at_m.x - grid->origin_m.x) / grid->spacing_m.x,
                              (at_m.y - grid->origin_m.y) / grid->spacing_m.y,
                              (at_m.z - grid->origin_m.z) / grid->spacing_m.z};
    double least = INFINITY, most = 0.0;
    /* One node more on each side, because a point on a node may be rounded into the next cell. */
    for (int n = 0; n < 64; n++) {
        const int steps[3] = {n % 4 - 1, n / 4 % 4 - 1, n / 16 - 1};
        bool inside = true;
        size_t at = 0;
        for (int axis = 2; axis >= 0; axis--) {
            const double node = floor(places[axis]) + steps[axis];
            inside &= node >= 0.0 && node < grid->size[axis];
            at = at * (size_t)grid->size[axis] + (size_t)fmax(0.0, node);
        }
        const double value = inside ? grid->values[at] : 0.0;
        least = fmin(least, value);
        most = fmax(most, value);
    }
    return most - least;
}

/* Vulkan requires weights that are multiples of 2^-bits; on each of three axes the value changes by
 * at most that part of the nodes' range. A texel has half a unit in its last place; below 2^-14 of
 * the largest density, half a denormal step. */
static double allowed(const struct neph_vulkan *vulkan, enum neph_texel_format format,
                      const struct neph_grid *grid, struct neph_vec3 at_m)
{
    const double weight = ldexp(1.0, -(int)vulkan->limits.subTexelPrecisionBits);
    const double value = neph_grid_density(grid, at_m) + spread_around(grid, at_m);
    const double texels[] = {
        [NEPH_TEXEL_R32F] = 0x1p-23 * value,
        [NEPH_TEXEL_R16F] = 0x1p-11 * value + 0x1p-25 * grid->maximum,
        [NEPH_TEXEL_R8] = 0.5 / 255.0 * grid->maximum,
    };
    return 3.0 * weight * spread_around(grid, at_m) + texels[format] + 1e-6 * grid->maximum;
}

static void test_values_are_within_weights_and_texels(void **state)
{
    struct neph_vulkan *vulkan = *state;
    struct point points[POINTS];
    OWNED(media) struct test_scene test;
    test_scene_build(&test, add_grids);
    choose_points(&test, points);
    for (int f = 0; f < NEPH_TEXEL_FORMAT_COUNT; f++) {
        const struct neph_shortcuts shortcuts = {.grid_texture = true,
                                                 .grid_format = (enum neph_texel_format)f};
        OWNED(memory) float *answers = ask(vulkan, &test, points, &shortcuts);
        double largest = 0.0, worst = 0.0;
        for (int i = 0; i < POINTS; i++) {
            const struct neph_medium *medium = &test.scene.media[i % 2];
            const struct neph_vec3 camera_m = test.key.position_m;
            const struct neph_vec3 at_m = {camera_m.x + (double)points[i].at_m[0],
                                           camera_m.y + (double)points[i].at_m[1],
                                           camera_m.z + (double)points[i].at_m[2]};
            const double off = fabs((double)answers[i] / medium->extinction_per_m -
                                    neph_grid_density(medium->grid, at_m));
            largest = fmax(largest, off / medium->grid->maximum);
            worst = fmax(worst, off / allowed(vulkan, shortcuts.grid_format, medium->grid, at_m));
        }
        print_message("%d: off by %.2e of the largest, %.2f of what is allowed\n", f, largest,
                      worst);
        assert_true(worst <= 1.0);
    }
}

/* --- marches ---------------------------------------------------------------------------------- */

static const struct neph_march_params marched = {.width_px = WIDTH_PX,
                                                 .height_px = HEIGHT_PX,
                                                 .steps = 32,
                                                 .transmittance = NEPH_MARCH_MARCHED,
                                                 .sun = NEPH_MARCH_MARCHED,
                                                 .sun_steps = 6};

/* A texture changes values by a few parts in a thousand, and no counter. Empty cells are skipped as
 * without: a cell with eight nodes of 0 is 0 for all weights. */
static void test_a_texture_changes_only_values(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_march_stats plain_stats, texture_stats;
    test_scene_build(&test, add_grids);
    struct neph_march_params params = marched;
    OWNED(image) struct neph_image *plain = test_march(*state, &test.scene, &params, &plain_stats);
    params.shortcuts = (struct neph_shortcuts){.grid_texture = true,
                                               .grid_format = NEPH_TEXEL_R16F};
    OWNED(image)
    struct neph_image *texture = test_march(*state, &test.scene, &params, &texture_stats);
    params.shortcuts.skip = true;
    OWNED(image) struct neph_image *skipped = test_march(*state, &test.scene, &params, NULL);
    const double off = test_largest_difference(plain, texture, NULL);
    print_message("by a texture: radiance off by %.2e\n", off);
    assert_true(off > 0.0 && off < 0.01);
    assert_int_equal(plain_stats.density_evaluations, texture_stats.density_evaluations);
    assert_true(test_largest_difference(texture, skipped, NULL) == 0.0);
    params.shortcuts.sun_cache = true;
    params.shortcuts.sun_cache_voxels = 48;
    OWNED(image) struct neph_image *cached = test_march(*state, &test.scene, &params, NULL);
    params.shortcuts.grid_texture = false;
    OWNED(image) struct neph_image *plain_cached = test_march(*state, &test.scene, &params, NULL);
    const double off_cached = test_largest_difference(plain_cached, cached, NULL);
    assert_true(off_cached > 0.0 && off_cached < 0.01);
    params.shortcuts = (struct neph_shortcuts){.grid_format = NEPH_TEXEL_R8}; /* unused */
    OWNED(image) struct neph_image *off_again = test_march(*state, &test.scene, &params, NULL);
    assert_true(test_largest_difference(plain, off_again, NULL) == 0.0);
}

/* With an only medium rays cross clear air before all else, and a texture has its own coordinates.
 * With a second medium behind the camera each step is separate. */
static void test_clear_air_adds_nothing(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_march_stats passed_stats, plain_stats;
    test_scene_build(&test, add_grids);
    struct neph_march_params params = marched;
    neph_medium_drift(&test.scene.media[1], (struct neph_vec3){0.0, 0.0, 200.0});
    OWNED(image) struct neph_image *plain = test_march(*state, &test.scene, &params, &plain_stats);
    params.shortcuts.grid_texture = true;
    OWNED(image) struct neph_image *plain_texture = test_march(*state, &test.scene, &params, NULL);
    test.scene.medium_count = 1;
    OWNED(image) struct neph_image *passed_texture = test_march(*state, &test.scene, &params, NULL);
    params.shortcuts.skip = true;
    OWNED(image)
    struct neph_image *skipped_texture = test_march(*state, &test.scene, &params, NULL);
    params.shortcuts = (struct neph_shortcuts){.grid_texture = false};
    OWNED(image)
    struct neph_image *passed = test_march(*state, &test.scene, &params, &passed_stats);
    const double off = test_largest_difference(plain_texture, passed_texture, NULL);
    print_message("clear air passed: off by %.2e in a texture\n", off);
    assert_true(test_largest_difference(plain, passed, NULL) == 0.0);
    assert_int_equal(plain_stats.density_evaluations, passed_stats.density_evaluations);
    assert_int_equal(plain_stats.view_steps, passed_stats.view_steps);
    assert_true(off < 1e-4);
    assert_true(test_largest_difference(passed_texture, skipped_texture, NULL) < 1e-6);
}

/* A grey texture as the only medium has its own march (shaders/march_texture.glsl); with a second
 * medium behind the camera the general one is used. The cases: steps that are no multiple of eight,
 * all remainders of six taps, growing steps, a sun along an axis, a shadowing solid, more octaves
 * than a ray keeps, emission. A CPU device has another form, in which the rays of a subgroup sample
 * the same steps, so the device is also treated as a GPU. */
static void test_a_texture_has_its_own_march(void **state)
{
    static const struct {
        enum neph_march_lighting lighting;
        int octaves, steps, sun_steps;
        double sun_growth;
        bool is_level, is_shaded, glows;
    } cases[] = {
        {NEPH_MARCH_OCTAVES, 8, 29, 10, 1.0, false, true, false},
        {NEPH_MARCH_SINGLE, 1, 32, 11, 1.5, true, false, false}, /* the cases below at night only */
        {NEPH_MARCH_OCTAVES, 9, 32, 5, 1.0, false, false, false},
        {NEPH_MARCH_SINGLE, 1, 32, 6, 1.0, false, false, true},
        {NEPH_MARCH_OCTAVES, 3, 13, 4, 1.2, false, true, false},
        {NEPH_MARCH_SINGLE, 1, 3, 1, 1.0, true, false, false},
    };
    struct neph_vulkan *vulkan = *state;
    const bool is_cpu = vulkan->description.is_cpu;
    OWNED(media) struct test_scene test;
    test_scene_init(&test);
    test_add_sphere(&test, (struct neph_vec3){-2.0, 3.0, -12.0}, 1.0);
    add_grids(&test);
    const struct neph_vec3 sun = test.scene.sun.direction;
    const int solid_count = test.scene.solid_count;
    neph_medium_drift(&test.scene.media[1], (struct neph_vec3){0.0, 0.0, 200.0});
    const size_t count = (size_t)neph_test_by_day(2, sizeof(cases) / sizeof(cases[0]));
    for (size_t i = 0; i < count; i++) {
        struct neph_march_stats here_stats, own_stats, plain_stats;
        struct neph_march_params params = marched;
        params.lighting = cases[i].lighting;
        params.steps = cases[i].steps;
        params.sun_steps = cases[i].sun_steps;
        params.shortcuts = (struct neph_shortcuts){.grid_texture = true,
                                                   .sun_growth = cases[i].sun_growth};
        test.scene.scattering = cases[i].lighting == NEPH_MARCH_OCTAVES ? NEPH_SCATTERING_MULTIPLE
                                                                        : NEPH_SCATTERING_SINGLE;
        test.scene.octaves = (struct neph_octaves){cases[i].octaves, 0.6, 0.4, 0.7};
        test.scene.sun.direction = cases[i].is_level ? (struct neph_vec3){0.0, 1.0, 0.0} : sun;
        test.scene.solid_count = cases[i].is_shaded ? solid_count : 0;
        test.scene.media[0].albedo = (struct neph_rgb){0.9, 0.8, 0.7};
        test.scene.media[0].emission_w_per_m2_sr = cases[i].glows ? white : make_grey(0.0);
        test.scene.medium_count = 2;
        OWNED(image) struct neph_image *all = test_march(*state, &test.scene, &params, NULL);
        test.scene.medium_count = 1;
        OWNED(image)
        struct neph_image *here = test_march(vulkan, &test.scene, &params, &here_stats);
        vulkan->description.is_cpu = false;
        OWNED(image) struct neph_image *own = test_march(vulkan, &test.scene, &params, &own_stats);
        params.shortcuts.skip = true;
        OWNED(image) struct neph_image *skipped = test_march(vulkan, &test.scene, &params, NULL);
        vulkan->description.is_cpu = is_cpu;
        params.shortcuts.skip = params.shortcuts.grid_texture = false;
        OWNED(image)
        struct neph_image *plain = test_march(*state, &test.scene, &params, &plain_stats);
        const double off = test_largest_difference(all, own, NULL);
        const double off_here = test_largest_difference(all, here, NULL);
        const double off_skipped = test_largest_difference(own, skipped, NULL);
        print_message("%zu: off by %.2e, here by %.2e, with cells skipped by %.2e\n", i, off,
                      off_here, off_skipped);
        assert_true(off < 1e-5 && test_largest_difference(plain, own, NULL) > 0.0);
        assert_true(off_here < 1e-5);
        assert_true(off_skipped < 1e-6); /* a driver may fuse the two differently */
        assert_int_equal(own_stats.density_evaluations, plain_stats.density_evaluations);
        assert_int_equal(own_stats.view_steps, plain_stats.view_steps);
        assert_int_equal(here_stats.density_evaluations, plain_stats.density_evaluations);
        assert_int_equal(here_stats.view_steps, plain_stats.view_steps);
    }
}

/* --- refusals --------------------------------------------------------------------------------- */

static void test_closed_forms_only_are_refused(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_diag diag = {0};
    test_scene_build(&test, add_grids);
    struct neph_march_params params = marched;
    params.shortcuts.grid_texture = true;
    params.transmittance = NEPH_MARCH_EXACT;
    assert_int_equal(neph_march_check(&test.scene, &params, &diag), NEPH_OK);
    params.sun = NEPH_MARCH_EXACT;
    assert_int_equal(neph_march_check(&test.scene, &params, &diag), NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "transmittance=marched"));
    params.transmittance = NEPH_MARCH_MARCHED;
    assert_int_equal(neph_march_check(&test.scene, &params, &diag), NEPH_OK);
}

/* A device that supports 8-bit formats only. */
static VKAPI_ATTR void VKAPI_CALL know_8_bits(VkPhysicalDevice device, VkFormat format,
                                              VkFormatProperties *properties)
{
    *properties = (VkFormatProperties){0};
    if (format == VK_FORMAT_R8_UNORM)
        properties->optimalTilingFeatures = ~0u;
}

static void test_a_format_that_the_device_lacks_is_named(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_march *march = NULL;
    struct neph_diag diag = {0};
    test_scene_build(&test, add_grids);
    const PFN_vkGetPhysicalDeviceFormatProperties known = vkGetPhysicalDeviceFormatProperties;
    struct neph_march_params params = marched;
    params.shortcuts = (struct neph_shortcuts){.grid_texture = true,
                                               .grid_format = NEPH_TEXEL_R16F};
    vkGetPhysicalDeviceFormatProperties = know_8_bits;
    const enum neph_status lacks = neph_march_create(*state, &test.scene, &params, &march, &diag);
    vkGetPhysicalDeviceFormatProperties = known;
    assert_int_equal(lacks, NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "grid_format=r16f"));
    assert_non_null(strstr(diag.hint, "grid_sampling=exact"));
}

/* --- in real time ----------------------------------------------------------------------------- */

/* By day the march itself, with kernels that exist already; at night the split frame. */
static struct neph_image *first_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                      const char *sampling)
{
    char assignments[256];
    snprintf(assignments, sizeof(assignments),
             "transmittance=marched sun=marched sun_steps=6 taa=off ray_dither=none "
             "upscale_dither=none grid_sampling=%s split=%s",
             sampling, neph_test_is_night() ? "four" : "none");
    const struct neph_settings settings = test_preset(NULL, assignments);
    const struct neph_realtime_params params = {WIDTH_PX, HEIGHT_PX, &settings, 7, NULL};
    return test_film(vulkan, scene, &params, 1, NULL);
}

static void test_textures_in_real_time(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, add_grids);
    OWNED(image) struct neph_image *exact = first_frame(*state, &test.scene, "exact");
    OWNED(image) struct neph_image *texture = first_frame(*state, &test.scene, "texture");
    const double off = test_largest_difference(exact, texture, NULL);
    print_message("in real time: radiance off by %.2e\n", off);
    assert_true(off > 0.0 && off < 0.01);
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Sun rays with few steps, which grow or are in a cone, compared with the same rule in double
 * precision; in a homogeneous medium they give its optical depth.
 */
#include "tests/renderer/frames.h"

#include "renderer/shortcuts.h"
#include "scenes/media.h"

enum { WIDTH_PX = 40, HEIGHT_PX = 24, PIXELS = WIDTH_PX * HEIGHT_PX };

static const struct neph_march_params marched = {.width_px = WIDTH_PX,
                                                 .height_px = HEIGHT_PX,
                                                 .steps = 16,
                                                 .transmittance = NEPH_MARCH_MARCHED,
                                                 .sun = NEPH_MARCH_MARCHED,
                                                 .sun_steps = 6};

/* --- in double precision -------------------------------------------------------------------- */

static struct neph_vec3 cross(struct neph_vec3 a, struct neph_vec3 b)
{
    return (struct neph_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Optical depth of a medium from a point towards the sun, which must not be at the zenith. */
static double compute_optical_depth(const struct neph_medium *medium, struct neph_vec3 from_m,
                                    struct neph_vec3 to_sun, const struct neph_march_params *params)
{
    const struct neph_bounds box = neph_medium_support(medium);
    const struct neph_shortcuts *rays = &params->shortcuts;
    const struct neph_vec3 right = neph_vec3_normalize(cross(to_sun, (struct neph_vec3){0, 1, 0}));
    const struct neph_vec3 up = cross(right, to_sun);
    double t0_m = 0.0, t1_m = 1e6, parts = 0.0, depth = 0.0;
    if (!neph_bounds_clip(&box, from_m, to_sun, &t0_m, &t1_m))
        return 0.0;
    for (int i = 0; i < params->sun_steps; i++)
        parts += pow(rays->sun_growth, i);
    for (int i = 0; i < params->sun_steps; i++) {
        const double length_m = (t1_m - t0_m) * pow(rays->sun_growth, i) / parts;
        double start_m = t0_m;
        for (int k = 0; k < i; k++)
            start_m += (t1_m - t0_m) * pow(rays->sun_growth, k) / parts;
        const double t_m = start_m + 0.5 * length_m, angle = M_PI * (3.0 - sqrt(5.0)) * i;
        const double width_m = t_m * rays->sun_cone * sqrt((i + 0.5) / params->sun_steps);
        const struct neph_vec3 on_ray_m = neph_vec3_along(from_m, to_sun, t_m);
        const struct neph_vec3 tap_m = neph_vec3_along(
            neph_vec3_along(on_ray_m, right, width_m * cos(angle)), up, width_m * sin(angle));
        depth += length_m * neph_medium_extinction_per_m(medium, tap_m);
    }
    return depth;
}

/* --- the ground's light --------------------------------------------------------------------- */

/* Optical depth towards the sun from the radiance of a pixel of horizontal ground. */
static double shown_depth(const struct neph_image *frame, const struct test_scene *test, int pixel)
{
    const double radiance = (double)neph_image_channel(frame, "R")[pixel];
    const double through = (double)neph_image_channel(frame, "transmittance.R")[pixel];
    const struct neph_sun *sun = &test->scene.sun;
    const double clear = test->solids[0].albedo.r / M_PI * sun->direction.y *
                         sun->irradiance_w_per_m2.r;
    return -log(radiance / through / clear);
}

/* Largest difference over all ground pixels, and the number of pixels with a medium towards the
 * sun. */
static double worst_difference(struct neph_vulkan *vulkan, const struct test_scene *test,
                               const struct neph_march_params *params, int *shaded)
{
    OWNED(image) struct neph_image *frame = test_march(vulkan, &test->scene, params, NULL);
    const float *z_m = neph_image_channel(frame, "Z");
    double worst = 0.0;
    *shaded = 0;
    assert_non_null(z_m);
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_pixel_ray ray = test_ray(&test->scene, WIDTH_PX, HEIGHT_PX, p);
        if (isinf(z_m[p]))
            continue;
        const double way_m = (test->solids[0].box.max_m.y - ray.origin_m.y) / ray.direction.y;
        const double own = compute_optical_depth(
            &test->scene.media[0], neph_vec3_along(ray.origin_m, ray.direction, way_m),
            test->scene.sun.direction, params);
        worst = fmax(worst, fabs(shown_depth(frame, test, p) - own));
        *shaded += own > 0.1;
    }
    return worst;
}

static void add_ground(struct test_scene *test)
{
    test->scene.scattering = NEPH_SCATTERING_NONE;
    test_add_box(test, (struct neph_vec3){-1e3, -3.0, -1e3}, (struct neph_vec3){1e3, -2.0, 1e3});
}

/* float32 has an error of 2e-6 m for a point at 20 m, where densities change by up to 0.9 in a cell
 * of 0.5 m, over six steps of a metre. */
static void test_through_voxels(void **state)
{
    static const struct neph_shortcuts rays[] = {
        {.sun_growth = 1.0, .sun_cone = 0.25},
        {.sun_growth = 1.6},
        {.sun_growth = 1.6, .sun_cone = 0.25},
        {.sun_growth = 1.6, .sun_cone = 0.25, .skip = true},
        {.sun_growth = 1.6, .grid_texture = true, .grid_format = NEPH_TEXEL_R32F},
        {.sun_growth = 1.6, .grid_texture = true, .grid_format = NEPH_TEXEL_R32F, .skip = true},
    };
    uint64_t random = 7;
    struct test_scene test;
    test_scene_build(&test, add_ground);
    OWNED(grid)
    struct neph_grid *grid = random_lattice((const int[3]){12, 11, 10},
                                            (struct neph_vec3){-3.0, 1.0, -15.0},
                                            (struct neph_vec3){0.6, 0.5, 0.7}, 0.0, &random);
    test_add(&test, make_voxels(0.9, grid));
    for (size_t i = 0; i < sizeof(rays) / sizeof(rays[0]); i++) {
        struct neph_march_params params = marched;
        int shaded;
        params.shortcuts = rays[i];
        const double worst = worst_difference(*state, &test, &params, &shaded);
        print_message("growth %g, cone %g, skip %d, texture %d: off by %.1e in %d pixels\n",
                      rays[i].sun_growth, rays[i].sun_cone, rays[i].skip, rays[i].grid_texture,
                      worst, shaded);
        assert_true(shaded > 20 && worst < 2e-5);
    }
}

/* The lengths add up to the path, for all points in the medium. */
static void test_in_an_even_medium(void **state)
{
    struct test_scene test;
    test_scene_build(&test, add_ground);
    const struct neph_bounds box = {{-500.0, -2.0, -500.0}, {500.0, 12.0, 500.0}};
    test_add(&test, make_homogeneous(0.05, box));
    struct neph_march_params params = marched;
    params.shortcuts = (struct neph_shortcuts){.sun_growth = 1.5, .sun_cone = 0.1};
    OWNED(image) struct neph_image *frame = test_march(*state, &test.scene, &params, NULL);
    const double depth = 0.05 * 14.0 / test.scene.sun.direction.y;
    const double shown = shown_depth(frame, &test, PIXELS - WIDTH_PX / 2);
    print_message("optical depth %.7f, where it is %.7f\n", shown, depth);
    assert_true(fabs(shown - depth) < 2e-6);
}

static void test_other_rays_are_refused(void **state)
{
    static const struct neph_shortcuts refused[] = {
        {.sun_growth = 4.5}, {.sun_growth = 1.0005}, {.sun_cone = 1.5}, {.sun_cone = -0.1}};
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.03, 0.05, 0.0);
    for (size_t i = 0; i < sizeof(refused) / sizeof(refused[0]); i++) {
        struct neph_diag diag = {0};
        struct neph_march_params params = marched;
        params.shortcuts = refused[i];
        assert_int_equal(neph_march_check(&test.scene, &params, &diag), NEPH_ERR_USAGE);
        assert_non_null(
            strstr(diag.message, refused[i].sun_growth > 0.0 ? "sun_growth" : "sun_cone"));
    }
}

#include "tests/renderer/main.h"

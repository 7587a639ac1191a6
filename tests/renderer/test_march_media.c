/* SPDX-License-Identifier: MIT
 *
 * Gaussian blobs, shells and voxel grids (scenes/media.h) in the ray marcher compared with the
 * exact transport in double precision; Horizon clouds compared with quadrature.
 */
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/frames.h"

#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"

static const struct neph_march_params params_32 = {.width_px = 32, .height_px = 18, .steps = 64};

struct difference {
    double transmittance, volume; /* largest differences; volume relative to the largest radiance */
};

static struct difference compare(struct neph_vulkan *vulkan, struct test_scene *test,
                                 const struct neph_march_params *params)
{
    struct difference worst = {0.0, 0.0};
    double brightest = 0.0;
    OWNED(image) struct neph_image *frame = test_march(vulkan, &test->scene, params, NULL);
    const struct test_rgb transmittance = test_layer(frame, "transmittance"),
                          volume = test_layer(frame, "volume");
    for (int p = 0; p < params->width_px * params->height_px; p++) {
        const struct neph_ray_light light = test_exact_ray(&test->scene, params->width_px,
                                                           params->height_px, p);
        const double *t = &light.transmittance.r, *v = &light.volume.r;
        for (int c = 0; c < 3; c++) {
            const double dt = fabs((double)transmittance.of[c][p] - t[c]);
            const double dv = fabs((double)volume.of[c][p] - v[c]);
            assert_true(isfinite(dt) && isfinite(dv));
            worst.transmittance = fmax(worst.transmittance, dt);
            worst.volume = fmax(worst.volume, dv);
            brightest = fmax(brightest, v[c]);
        }
    }
    worst.volume /= brightest;
    return worst;
}

/* From the ground of a small planet, low above the horizon, where the path is longest. All rays
 * rise. */
static void scene_shell(struct test_scene *test)
{
    struct neph_medium *shell = test_add_cloud(test, NEPH_MEDIUM_SHELL, 2e-4);
    shell->shell = (struct neph_shell){{0.0, -6.371e6, 0.0}, 6.371e6, 8000.0};
    shell->bounds = (struct neph_bounds){{-3e6, -1e6, -3e6}, {3e6, 1.5e5, 3e6}};
    test->key.look_at_m = (struct neph_vec3){0.0, 6.6, -10.0};
}

/* Fog on the ground of a planet: a ray's path through it ends where it hits the sphere. */
static void scene_planet(struct test_scene *test)
{
    const double radius_m = 6.371e6;
    struct neph_medium *fog = test_add_medium(test, 0.03, 0.1, 0.0);
    fog->bounds = (struct neph_bounds){{-900, -10, -900}, {900, 60, 900}};
    test_add_sphere(test, (struct neph_vec3){0.0, -radius_m, 0.0}, radius_m);
    test->key.look_at_m = (struct neph_vec3){0.0, 0.4, -10.0};
}

/* Transmittance has float32 precision. In-scattering converges with the square of the step;
 * trilinear densities have kinks at the faces of cells. */
static void test_media_converge(void **state)
{
    static const struct {
        const char *name;
        void (*build)(struct test_scene *);
        int steps;
        double order_min;
    } cases[] = {{"Gaussian", scene_blob, 64, 1.8},
                 {"shell", scene_shell, 512, 1.8},
                 {"planet", scene_planet, 128, 1.8},
                 {"grid", scene_voxels, 64, 1.5}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(media) struct test_scene test;
        struct neph_march_params params = params_32;
        test_scene_build(&test, cases[i].build);
        params.steps = cases[i].steps;
        const struct difference coarse = compare(*state, &test, &params);
        params.steps *= 4;
        const struct difference fine = compare(*state, &test, &params);
        const double order = log2(coarse.volume / fine.volume) / 2.0;
        print_message("%-9s T off by %.1e; volume by %.1e, %.1e: order %.2f\n", cases[i].name,
                      fine.transmittance, coarse.volume, fine.volume, order);
        assert_true(fine.transmittance < 3e-6);
        assert_true(fine.volume < 2e-3 && order > cases[i].order_min);
    }
}

static void test_all_at_once_and_coloured(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_blob);
    scene_voxels(&test);
    /* Bounded, because fixed steps over kilometres of fog would miss the blob. */
    test_add_medium(&test, 0.01, 0.02, 0.0)->bounds = (struct neph_bounds){{-20, -9, -30},
                                                                           {20, 12, 5}};
    test.scene.media[0].extinction_color = (struct neph_rgb){0.4, 1.0, 2.0};
    test.scene.media[2].extinction_color = (struct neph_rgb){1.0, 0.5, 0.0};
    test.scene.scattering = NEPH_SCATTERING_NONE;
    struct neph_march_params params = params_32;
    const struct difference exact = compare(*state, &test, &params);
    assert_true(exact.transmittance < 3e-6);
    params.transmittance = NEPH_MARCH_MARCHED;
    params.steps = 1024;
    const struct difference marched = compare(*state, &test, &params);
    print_message("coloured: T off by %.1e exact, %.1e marched\n", exact.transmittance,
                  marched.transmittance);
    assert_true(marched.transmittance < 1e-3 /* faces within a step */);
}

/* --- Horizon clouds ----------------------------------------------------------------------- */

/* Single scattering of sunlight by the midpoint rule, with optical depths by quadrature. */
static double single_scattering(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                struct neph_vec3 direction, double end_m, int points)
{
    const double cosine = neph_vec3_dot(direction, scene->sun.direction);
    const double step_m = end_m / points;
    double depth = 0.0, sum = 0.0;
    for (int i = 0; i < points; i++) {
        double own = 0.0, scattered_per_sr = 0.0;
        for (int m = 0; m < scene->medium_count; m++) {
            const struct neph_medium *medium = &scene->media[m];
            const double part = neph_medium_optical_depth(medium, origin_m, direction, i * step_m,
                                                          (i + 1) * step_m);
            own += part;
            scattered_per_sr += part * medium->albedo.g * neph_phase_per_sr(&medium->phase, cosine);
        }
        if (own > 0.0) {
            const struct neph_vec3 p = neph_vec3_along(origin_m, direction, (i + 0.5) * step_m);
            const double sun =
                neph_scene_optical_depth(scene, p, scene->sun.direction, 0.0, INFINITY).g;
            sum += exp(-depth) * -expm1(-own) * scattered_per_sr / own * exp(-sun);
        }
        depth += own;
    }
    return sum * scene->sun.irradiance_w_per_m2.g;
}

/* Cumulus clouds through a box of fog: marched media, and media with a closed form. One row of
 * pixels. Both rules are of second order; the reference's steps of 13 m at details of 9 m have an
 * error of some 1e-3 of the largest radiance, the march's steps of 8 m a smaller one. */
static void test_horizon_scattering_against_quadrature(void **state)
{
    OWNED(media) struct test_scene test;
    struct neph_diag diag = {0};
    const struct neph_horizon_params cumulus = make_cumulus();
    test_scene_init(&test);
    struct neph_medium *cloud = test_add_cloud(&test, NEPH_MEDIUM_HORIZON, 0.01);
    cloud->bounds = (struct neph_bounds){{-1500.0, 0.0, -3000.0}, {1500.0, 2e3, 0.0}};
    neph_assert_ok(neph_horizon_create(&cumulus, &cloud->horizon, &diag), &diag);
    test_add_medium(&test, 3e-4, 0.0, 0.0)->bounds = (struct neph_bounds){{-400.0, 0.0, -900.0},
                                                                          {300.0, 1500.0, 0.0}};
    test.key.look_at_m = (struct neph_vec3){0.0, 6.6, -10.0};
    const struct neph_march_params params = {
        .width_px = 6, .height_px = 3, .steps = 512, .sun_steps = 64};
    OWNED(image) struct neph_image *frame = test_march(*state, &test.scene, &params, NULL);
    const float *volume = neph_image_channel(frame, "volume.G");
    double worst = 0.0, brightest = 0.0;
    for (int i = 0; i < 6; i++) {
        const struct neph_pixel_ray ray = test_ray(&test.scene, 6, 3, i);
        const double expected = single_scattering(&test.scene, ray.origin_m, ray.direction, 4e3,
                                                  300);
        worst = fmax(worst, fabs((double)volume[i] - expected));
        brightest = fmax(brightest, expected);
    }
    print_message("Horizon: volume off by %.1e of %.2g\n", worst, brightest);
    assert_true(brightest > 0.05 && worst < 2e-3 * brightest);
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * A bright medium in or behind a dark one that causes nearly all collisions: the path tracer must
 * sample the bright one, and estimate its error correctly. The mean of two hundred paths is within
 * 4.5 standard errors of the closed form (wrong once in 150 000 for a normal variable; seeds are
 * fixed) plus 1e-12 for rounding, and the standard error is below a fifth of the value: no estimate
 * is 0 with variance 0.
 */
#include "tests/scene_builders.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/sources.h"
#include "truth/path.h"
#include "truth/transport.h"

enum { PATHS = 200 };

static const double sigmas = 4.5;
static const struct neph_vec3 ahead = {0, 0, -1};
static const struct neph_vec3 eye_m = {0, 0, 10};

/* The camera's ray is inside from z0 + length_m down to z0. */
static struct neph_medium plate(double extinction_per_m, double z0_m, double length_m,
                                struct neph_rgb albedo)
{
    struct neph_medium medium = make_homogeneous(
        extinction_per_m, (struct neph_bounds){{-1e4, -1e4, z0_m}, {1e4, 1e4, z0_m + length_m}});
    medium.albedo = albedo;
    return medium;
}

static double channel_of(struct neph_rgb rgb, int channel)
{
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

static void hold(const char *what, const struct neph_scene *scene, struct neph_vec3 origin_m,
                 struct neph_rgb expected)
{
    struct neph_diag diag = {0};
    struct neph_tracker *tracker;
    struct neph_tracking_cost cost = {0, 0};
    struct neph_flight flight;
    double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    const struct neph_view view = neph_view_create(scene, origin_m, ahead);
    const struct neph_ray ray = {origin_m, ahead, view.hit.t_m};
    neph_flight_init(&flight, scene, &ray);
    for (int n = 0; n < PATHS; n++) {
        struct neph_random random = neph_random_stream(11, 0, (uint64_t)n);
        const struct neph_path_light light = neph_path_trace(scene, tracker, &view, &flight,
                                                             &random, &cost);
        for (int j = 0; j < 3; j++) {
            const double value = channel_of(light.volume, j);
            sum[j] += value;
            squares[j] += value * value;
        }
    }
    neph_tracker_destroy(tracker);
    for (int j = 0; j < 3; j++) {
        const double mean = sum[j] / PATHS, truth = channel_of(expected, j);
        const double error = sqrt(fmax(0.0, squares[j] / PATHS - mean * mean) / (PATHS - 1));
        if (!(fabs(mean - truth) <= sigmas * error + 1e-12 * truth && error <= 0.2 * truth))
            fail_msg("%s, channel %d: %g +- %g, expected %g", what, j, mean, error, truth);
    }
}

/* Both media fill the same 4 m: L = glow k_b / k (1 - e^-(4 k)). */
static void test_thin_glow_in_a_dark_medium(void **state)
{
    for (double bright_per_m = 1e-2; bright_per_m > 1e-9; bright_per_m *= 0.1) {
        const double k_per_m = 0.7 + bright_per_m;
        struct neph_scene scene = {.scattering = NEPH_SCATTERING_NONE, .medium_count = 2};
        scene.media[0] = plate(0.7, 0, 4, make_grey(0));
        scene.media[1] = plate(bright_per_m, 0, 4, make_grey(0.5));
        scene.media[1].emission_w_per_m2_sr = (struct neph_rgb){2, 4, 6};
        const double part = bright_per_m / k_per_m * -expm1(-4.0 * k_per_m);
        hold("a glow", &scene, eye_m, (struct neph_rgb){part, 2.0 * part, 3.0 * part});
    }
}

/* Behind an optical depth that free flights practically never pass. */
static void test_a_glow_behind_a_dark_medium(void **state)
{
    for (double depth = 5.0; depth < 80.0; depth *= 2.0) {
        struct neph_scene scene = {.scattering = NEPH_SCATTERING_NONE, .medium_count = 2};
        scene.media[0] = plate(depth / 2.0, 0, 2, make_grey(0));
        scene.media[1] = plate(1e-3, -2, 1, make_grey(0));
        scene.media[1].emission_w_per_m2_sr = make_grey(5);
        hold("behind", &scene, eye_m, make_grey(5.0 * -expm1(-1e-3) * exp(-depth)));
    }
}

/* The sun is behind the camera: light travels the same path twice, L = E a k_b / (4 pi) (1 - e^-(2
 * k 4)) / (2 k). The dark medium may be dark in one channel only. */
static void test_thin_cloud_in_a_dark_medium(void **state)
{
    static const struct neph_rgb albedos[] = {{0, 0, 0}, {0.9, 0.9, 0}};
    for (size_t i = 0; i < 2; i++)
        for (double bright_per_m = 1e-2; bright_per_m > 1e-7; bright_per_m *= 0.1) {
            const double k_per_m = 0.7 + bright_per_m;
            const struct neph_vec3 back = {0, 0, 1};
            struct neph_scene scene = make_sunny(plate(0.7, 0, 4, albedos[i]), back);
            scene.media[scene.medium_count++] = plate(bright_per_m, 0, 4, make_grey(0.5));
            const double whole = -expm1(-8.0 * k_per_m) / (2.0 * k_per_m) / (4.0 * M_PI);
            const double dark = 0.7 * whole, bright = 0.5 * bright_per_m * whole;
            hold("a cloud", &scene, eye_m,
                 (struct neph_rgb){albedos[i].r * dark + bright, albedos[i].g * dark + bright,
                                   albedos[i].b * dark + bright});
        }
}

/* In a thin cloud second and higher orders are negligible: relative to its first order they are of
 * the size of its optical depth. */
static void test_all_orders(void **state)
{
    const struct neph_vec3 back = {0, 0, 1};
    struct neph_scene scene = make_sunny(plate(0.7, 0, 4, make_grey(0)), back);
    scene.scattering = NEPH_SCATTERING_MULTIPLE;
    scene.media[scene.medium_count++] = plate(1e-9, 0, 4, make_grey(0.5));
    const double k_per_m = 0.7 + 1e-9;
    hold("all orders", &scene, eye_m,
         make_grey(0.5e-9 * -expm1(-8.0 * k_per_m) / (2.0 * k_per_m) / (4.0 * M_PI)));
}

/* A glow behind Horizon layers; the path tracer estimates their optical depth by sampling. */
static void test_horizon_layers_that_are_dark(void **state)
{
    struct neph_diag diag = {0};
    struct neph_horizon_params params = make_cumulus();
    params.coverage = 1.0;
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_NONE, .medium_count = 2};
    scene.media[0] = make_medium(NEPH_MEDIUM_HORIZON, 1.0);
    scene.media[0].bounds = (struct neph_bounds){{-3000, 0, -3000}, {3000, 2000, 0}};
    scene.media[0].albedo = make_grey(0);
    neph_assert_ok(neph_horizon_create(&params, &scene.media[0].horizon, &diag), &diag);
    scene.media[1] = plate(1e-6, -3100, 50, make_grey(0));
    scene.media[1].emission_w_per_m2_sr = make_grey(3);
    const struct neph_vec3 in_clouds_m = {0, 1000, 10};
    const double depth = neph_scene_optical_depth(&scene, in_clouds_m, ahead, 0.0, 3050.0).g;
    assert_true(depth > 0.0);
    scene.media[0].extinction_per_m *= 4.0 / depth;
    hold("Horizon", &scene, in_clouds_m, make_grey(3.0 * -expm1(-50e-6) * exp(-4.0)));
    neph_horizon_destroy(scene.media[0].horizon);
}

/* Media with equal sources keep the previous estimator. */
static void test_which_scenes_differ(void **state)
{
    struct neph_scene scene = make_sunny(plate(0.7, 0, 4, make_grey(0)), ahead);
    assert_false(neph_scene_sources_differ(&scene)); /* there is only one */
    scene.media[scene.medium_count++] = plate(0.1, 0, 4, make_grey(0.5));
    assert_true(neph_scene_sources_differ(&scene));
    scene.media[0].albedo = (struct neph_rgb){0.5, 0.5, 0.05};
    assert_true(neph_scene_sources_differ(&scene));
    scene.media[0].albedo.b = 0.07;
    assert_false(neph_scene_sources_differ(&scene));
    scene.media[0].emission_w_per_m2_sr = make_grey(1);
    assert_true(neph_scene_sources_differ(&scene));
    scene.media[0].extinction_color = scene.media[1].extinction_color = make_grey(0);
    assert_false(neph_scene_sources_differ(&scene));
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Light of point lights scattered in media, against closed forms and plain quadrature without the
 * substitution, and paths against both; all orders against energy conservation in a white medium.
 */
#include "tests/lamp_stage.h"

#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/quadrature.h"
#include "scenes/solids.h"
#include "truth/directions.h"
#include "truth/lamp_draw.h"
#include "truth/lamp_peak.h"
#include "truth/path.h"
#include "truth/transport.h"

static struct neph_scene make_lamplit(struct neph_medium medium, struct neph_vec3 position_m)
{
    return (struct neph_scene){
        .scattering = NEPH_SCATTERING_SINGLE,
        .light_count = 1,
        .lights = {{.position_m = position_m, .intensity_w_per_sr = {1, 1, 1}}},
        .medium_count = 1,
        .media = {medium},
    };
}

/* ---- closed forms ---- */

/* E1 by its series (Abramowitz & Stegun 5.1.11), for x up to about 8: digits of e^x are lost. */
static double exponential_integral(double x)
{
    const double euler = 0.57721566490153286061;
    double sum = -euler - log(x), term = 1.0;
    for (int n = 1; n < 80; n++) {
        term *= -x / n;
        sum -= term / n;
    }
    return sum;
}

/* A point light at the distance b behind a camera that looks away from it: the integral over t of
 * sigma/(4 pi) e^(-sigma (2 t + b)) / (t + b)^2 is sigma e^(sigma b) E2(2 sigma b) / (4 pi b). */
static void test_away_from_a_lamp(void **state)
{
    for (double depth = 1e-6; depth < 4.0; depth *= 7.0) {
        const double sigma = 0.3, b_m = depth / sigma, x = 2.0 * depth;
        const double e2 = exp(-x) - x * exponential_integral(x);
        const struct neph_scene scene = make_lamplit(make_homogeneous(sigma, everywhere),
                                                     (struct neph_vec3){0, 0, b_m});
        const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 0, 0},
                                                               (struct neph_vec3){0, 0, -1});
        neph_assert_close(light.volume.r, sigma * exp(depth) * e2 / (4.0 * M_PI * b_m), 1e-10, 0.0);
        assert_true(light.quadrature_error <= 1e-10 * light.volume.r);
    }
}

/* B. Sun et al., SIGGRAPH 2005: isotropic and infinite, a point light at the distance D and an
 * angle, L = sigma e^(-sigma D cos) / (2 pi D sin) (F(u, pi/2) - F(u, angle/2)), u = sigma D sin,
 * with F(u, v) = the integral of e^(-u tan x) from 0 to v. */
struct sun_et_al {
    double u;
};

/* x is measured from pi/2 downwards. */
static double sun_integrand(double x, const void *context)
{
    return exp(-((const struct sun_et_al *)context)->u / tan(x));
}

/* Finer towards pi/2, where the exponent goes to infinity. */
static double sun_airlight(double sigma, double distance_m, double angle_rad)
{
    const struct sun_et_al f = {sigma * distance_m * sin(angle_rad)};
    double sum = 0.0, high = 0.5 * M_PI - 0.5 * angle_rad;
    for (int i = 0; i < 400; i++, high *= 0.9)
        sum += neph_gauss(sun_integrand, &f, 0.9 * high, high);
    return sigma * exp(-sigma * distance_m * cos(angle_rad)) /
           (2.0 * M_PI * distance_m * sin(angle_rad)) * sum;
}

static void test_the_airlight_model_of_sun_et_al(void **state)
{
    const double sigmas[] = {1e-4, 0.05, 0.4, 3.0}, angles_deg[] = {0.01, 2, 30, 90, 130, 179};
    for (size_t s = 0; s < COUNT(sigmas); s++)
        for (size_t a = 0; a < COUNT(angles_deg); a++) {
            const double distance_m = 2.5, rad = angles_deg[a] * NEPH_RAD_PER_DEG;
            const struct neph_scene scene = make_lamplit(
                make_homogeneous(sigmas[s], everywhere),
                (struct neph_vec3){distance_m * sin(rad), 0, -distance_m * cos(rad)});
            const double found = neph_transport_ray(&scene, (struct neph_vec3){0, 0, 0},
                                                    (struct neph_vec3){0, 0, -1})
                                     .volume.r;
            neph_assert_close(found, sun_airlight(sigmas[s], distance_m, rad), 1e-10, 0.0);
        }
}

/* Thin air between two planes: sigma/(4 pi) I (theta1 - theta0) / h. */
static void test_thin_air_by_hand(void **state)
{
    const double sigma = 1e-13, heights_m[] = {3.0, 1e-2, 1e-7};
    for (size_t i = 0; i < COUNT(heights_m); i++) {
        const double h_m = heights_m[i];
        const struct neph_scene scene = make_lamplit(
            make_homogeneous(sigma, (struct neph_bounds){{-9, -9, -6}, {9, 9, -1}}),
            (struct neph_vec3){0, h_m, -3});
        const double found = neph_transport_ray(&scene, (struct neph_vec3){0, 0, 0},
                                                (struct neph_vec3){0, 0, -1})
                                 .volume.r;
        neph_assert_close(found, sigma / (4.0 * M_PI) * (atan(3.0 / h_m) + atan(2.0 / h_m)) / h_m,
                          1e-11, 0.0);
    }
}

/* ---- plain quadrature ---- */

struct plain {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
};

static void plain_source(double t_m, void *context, double value[3])
{
    const struct plain *plain = context;
    const struct neph_scene *scene = plain->scene;
    const struct neph_vec3 point_m = neph_vec3_along(plain->origin_m, plain->direction, t_m);
    struct neph_rgb sum = {0, 0, 0};
    for (int l = 0; l < scene->light_count; l++) {
        const struct neph_lit lit = neph_light_at(&scene->lights[l], point_m);
        if (!neph_scene_sees(scene, point_m, scene->lights[l].position_m))
            continue;
        const struct neph_rgb depth = neph_rgb_add(
            neph_scene_optical_depth(scene, plain->origin_m, plain->direction, 0.0, t_m),
            neph_scene_optical_depth(scene, point_m, lit.direction, 0.0, lit.distance_m));
        const struct neph_rgb through = {exp(-depth.r), exp(-depth.g), exp(-depth.b)};
        for (int m = 0; m < scene->medium_count; m++) {
            const struct neph_medium *medium = &scene->media[m];
            const double per_m_sr =
                neph_medium_extinction_per_m(medium, point_m) *
                neph_phase_per_sr(&medium->phase, neph_vec3_dot(plain->direction, lit.direction));
            sum = neph_rgb_add(
                sum,
                neph_rgb_scale(neph_rgb_mul(neph_rgb_mul(medium->albedo, medium->extinction_color),
                                            neph_rgb_mul(lit.irradiance_w_per_m2, through)),
                               per_m_sr));
        }
    }
    value[0] = sum.r;
    value[1] = sum.g;
    value[2] = sum.b;
}

/* The midpoint rule at 6e4 positions: edges of shadows are first order, 1e-4 of the whole. */
static void test_a_stage_against_plain_quadrature(void **state)
{
    struct test_scene test;
    const struct neph_scene *scene = &lamp_stage(&test)->scene;
    for (int i = 0; i < 24; i += 3) {
        struct plain plain = {scene, test.key.position_m, lamp_direction(i)};
        const struct neph_ray_light light = neph_transport_ray(scene, plain.origin_m,
                                                               plain.direction);
        const double end_m = fmin(light.hit_m, 40.0);
        enum { PLACES = 60000 };
        double sum[3] = {0}, value[3];
        for (int p = 0; p < PLACES; p++) {
            plain_source(end_m * (p + 0.5) / PLACES, &plain, value);
            for (int j = 0; j < 3; j++)
                sum[j] += value[j] * end_m / PLACES;
        }
        neph_assert_close(light.volume.r, sum[0], 3e-4, 1e-9);
        neph_assert_close(light.volume.g, sum[1], 3e-4, 1e-9);
        neph_assert_close(light.volume.b, sum[2], 3e-4, 1e-9);
    }
}

/* A plate under a point light and a spot light, in fog: albedo / pi I cos / d^2 e^-depth. */
static void test_a_lamplit_surface_by_hand(void **state)
{
    struct neph_solid plate = make_box(-9, -1, -9, 9, 0, 9);
    plate.albedo = (struct neph_rgb){0.5, 0.25, 1.0};
    struct neph_scene scene = make_lamplit(make_homogeneous(0.2, everywhere),
                                           (struct neph_vec3){3, 4, 0});
    scene.scattering = NEPH_SCATTERING_NONE;
    scene.solids = &plate;
    scene.solid_count = 1;
    const struct neph_ray_light light = neph_transport_ray(&scene, (struct neph_vec3){0, 1, 0},
                                                           (struct neph_vec3){0, -1, 0});
    neph_assert_close(light.radiance.r,
                      0.5 / M_PI * (4.0 / 5.0) / 25.0 * exp(-0.2 * 5.0) * exp(-0.2), 1e-12, 0.0);
    scene.lights[0].is_spot = true; /* faces away */
    scene.lights[0].axis = (struct neph_vec3){0, 1, 0};
    scene.lights[0].inner_cosine = 0.9;
    scene.lights[0].outer_cosine = 0.8;
    assert_true(
        neph_transport_ray(&scene, (struct neph_vec3){0, 1, 0}, (struct neph_vec3){0, -1, 0})
            .radiance.r == 0.0);
}

/* ---- lights on and near rays ---- */

static double near_source(double t_m, const void *context)
{
    const double light_m = *(const double *)context;
    const double d_m = t_m - light_m;
    return 0.5 / (4.0 * M_PI * d_m * d_m) * exp(-0.5 * (t_m - 4.0)) *
           exp(-0.5 * (d_m > 0.0 ? t_m - 4.0 : 6.0 - t_m));
}

/* Along a ray through the light 1 / d^2 is smooth outside of the light: Gauss on 64 parts. */
static void test_a_light_on_the_ray_outside_the_fog(void **state)
{
    const double lights_m[] = {0.0, 1e-7, 2.0, 3.999, 6.001, 8.0};
    for (size_t i = 0; i < COUNT(lights_m); i++) {
        const struct near_lamp lamp = {.light_m = {0, 0, 5 - lights_m[i]}};
        struct test_scene test;
        const struct neph_scene *scene = near_lamp_stage(&test, &lamp);
        double sum = 0.0;
        for (int part = 0; part < 64; part++) {
            /* Finer towards the nearer face. */
            const double x0 = pow(part / 64.0, 4), x1 = pow((part + 1) / 64.0, 4);
            const bool is_before = lights_m[i] < 5.0;
            sum += is_before ? neph_gauss(near_source, &lights_m[i], 4 + 2 * x0, 4 + 2 * x1)
                             : neph_gauss(near_source, &lights_m[i], 6 - 2 * x1, 6 - 2 * x0);
        }
        const double found =
            neph_transport_ray(scene, test.key.position_m, (struct neph_vec3){0, 0, -1}).volume.r;
        neph_assert_close(found, sum, 1e-9, 0.0);
    }
}

/* The integral diverges there. */
static void test_a_light_on_the_ray_in_the_fog_has_no_value(void **state)
{
    const struct {
        struct neph_vec3 light_m, axis; /* a spot's; 0: none */
        double eye_z_m;
        bool is_infinite;
    } cases[] = {
        {{0, 0, 0}, {0, 0, 0}, 5, true},       /* inside */
        {{0, 0, 1}, {0, 0, 0}, 5, true},       /* on the near face */
        {{0, 0, -1}, {0, 0, 0}, 5, true},      /* on the far face */
        {{0, 0, 1.0001}, {0, 0, 0}, 5, false}, /* in front of it */
        {{0, 0, 0}, {0, 1, 0}, 5, false},      /* a spot light that shines past the ray */
        {{0, 0, 0}, {0, 0, 1}, 5, true},       /* a spot light that shines along it */
        {{0, 1e-9, 0}, {0, 0, 0}, 5, false},   /* next to the ray */
        {{0, 0, 0.5}, {0, 0, 0}, 0.5, true},   /* at an eye in the fog */
        {{0, 0, 0.5}, {0, 0, 0}, 0.25, false}, /* behind it */
        {{0, 0, 0.5}, {0, 0, 1}, 0.5, false},  /* at the eye, a spot light that shines backwards */
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct near_lamp lamp = {.light_m = cases[i].light_m};
        struct test_scene test;
        struct neph_scene *scene = near_lamp_stage(&test, &lamp);
        test.key.position_m.z = cases[i].eye_z_m;
        test.key.look_at_m.z = cases[i].eye_z_m - 1.0;
        scene->lights[0].is_spot = neph_vec3_length(cases[i].axis) > 0.0;
        scene->lights[0].axis = cases[i].axis;
        scene->lights[0].inner_cosine = 0.9;
        scene->lights[0].outer_cosine = 0.8;
        const struct neph_camera camera = neph_scene_camera(scene, 0.0);
        struct neph_lamp_peak peak;
        assert_int_equal(neph_find_lamp_peak(scene, &camera, 15, 9, &peak), cases[i].is_infinite);
        const double found =
            neph_transport_ray(scene, test.key.position_m, (struct neph_vec3){0, 0, -1}).volume.r;
        assert_int_equal(isinf(found), cases[i].is_infinite);
        if (!cases[i].is_infinite)
            continue;
        assert_int_equal(peak.light, 0);
        if (!peak.is_at_the_eye)
            assert_true(peak.column == 7 && peak.row == 4);
    }
}

/* ---- paths ---- */

struct estimate {
    double mean[3], error[3];
};

static void add_path(struct estimate *sums, struct neph_rgb light)
{
    const double value[3] = {light.r, light.g, light.b};
    for (int j = 0; j < 3; j++) {
        assert_true(isfinite(value[j]) && value[j] >= 0.0);
        sums->mean[j] += value[j];
        sums->error[j] += value[j] * value[j];
    }
}

static void finish(struct estimate *sums, int samples)
{
    for (int j = 0; j < 3; j++) {
        const double mean = sums->mean[j] / samples;
        sums->error[j] = sqrt(fmax(0.0, sums->error[j] / samples - mean * mean) / (samples - 1));
        sums->mean[j] = mean;
    }
}

/* Paths of one view. */
static struct estimate trace_view(const struct neph_scene *scene,
                                  const struct neph_tracker *tracker, const struct neph_view *view,
                                  int pixel, int samples)
{
    struct neph_flight flight;
    const struct neph_ray ray = {view->origin_m, view->direction, view->hit.t_m};
    struct neph_tracking_cost cost = {0, 0};
    struct estimate sums = {{0}, {0}};
    neph_flight_init(&flight, scene, &ray);
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(9, (uint64_t)pixel, (uint64_t)n);
        add_path(&sums, neph_path_trace(scene, tracker, view, &flight, &random, &cost).volume);
    }
    finish(&sums, samples);
    return sums;
}

/* 4.5 standard errors, as in test_path.c. */
static void test_paths_against_the_stage(void **state)
{
    struct test_scene test;
    struct neph_scene *scene = &lamp_stage(&test)->scene;
    struct neph_tracker *tracker;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    const int samples = neph_test_paths(3000);
    for (int with_sun = 0; with_sun < 2; with_sun++)
        for (int i = 0; i < 24; i += 5) {
            scene->sun.present = with_sun;
            const struct neph_view view = neph_view_create(scene, test.key.position_m,
                                                           lamp_direction(i));
            const struct neph_ray_light truth = neph_transport_ray(scene, view.origin_m,
                                                                   view.direction);
            const struct estimate sums = trace_view(scene, tracker, &view, i, samples);
            neph_assert_close(view.unscattered.g, truth.radiance.g - truth.volume.g, 1e-9, 1e-12);
            neph_assert_close(sums.mean[0], truth.volume.r, 0.0, 4.5 * sums.error[0] + 1e-12);
            neph_assert_close(sums.mean[1], truth.volume.g, 0.0, 4.5 * sums.error[1] + 1e-12);
            neph_assert_close(sums.mean[2], truth.volume.b, 0.0, 4.5 * sums.error[2] + 1e-12);
            assert_true(sums.error[1] <= neph_test_noise(0.1) * truth.volume.g);
        }
    neph_tracker_destroy(tracker);
}

/* A fog without bounds or ground; its extinction grows downwards to infinity. Blue is not
 * attenuated. Every path returns a finite value, and the mean of single scattering is the exact
 * one. The rays are level, downwards, straight down and upwards. */
static void test_fog_without_ground(void **state)
{
    static const struct neph_vec3 ways[] = {{0.1, 0, -1}, {0.1, -0.6, -1}, {0, -1, 0}, {0, 1, -1}};
    const int samples = neph_test_paths(4000);
    for (int second = 0; second < 2; second++) {
        struct neph_scene scene = make_lamplit(make_height_fog(0.05, 0.3),
                                               (struct neph_vec3){-1, 2.4, -9});
        scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.5, 0.0};
        scene.media[0].albedo = make_grey(0.9);
        scene.media[0].layers[1] = (struct neph_fog_layer){0.01, 0.02, 0.0};
        scene.media[0].layer_count = 1 + second;
        struct neph_tracker *tracker;
        struct neph_diag diag = {0};
        neph_assert_ok(neph_tracker_create(&scene, &tracker, &diag), &diag);
        for (int i = 0; i < 4; i++) {
            const struct neph_view view = neph_view_create(&scene, (struct neph_vec3){0, 2, 0},
                                                           neph_vec3_normalize(ways[i]));
            scene.scattering = NEPH_SCATTERING_SINGLE;
            const struct neph_rgb truth =
                neph_transport_ray(&scene, view.origin_m, view.direction).volume;
            const struct estimate sums = trace_view(&scene, tracker, &view, i, samples);
            neph_assert_close(sums.mean[0], truth.r, 0.0, 4.5 * sums.error[0]);
            neph_assert_close(sums.mean[1], truth.g, 0.0, 4.5 * sums.error[1]);
            assert_true(truth.g > 0.0 && truth.b == 0.0 && sums.mean[2] == 0.0);
            scene.scattering = NEPH_SCATTERING_MULTIPLE;
            trace_view(&scene, tracker, &view, i, samples / 4);
        }
        neph_tracker_destroy(tracker);
    }
}

/* Lines into the sphere by the cosine law, or half of them towards the light: lines that pass it at
 * a distance h contribute 1/h, whose mean square would be unbounded. */
struct line {
    struct neph_vec3 direction;
    double weight;
};

static struct line random_line(const struct neph_scene *scene, struct neph_vec3 out,
                               struct neph_random *random)
{
    const struct neph_vec3 at_m = neph_vec3_scale(out, 2.0), inward = neph_vec3_scale(out, -1.0);
    struct line line = {.direction = neph_cosine_sample(inward, random)};
    if (neph_random_uniform(random) < 0.5)
        line.direction = neph_lamp_direction_draw(scene, at_m, random);
    const double wanted = fmax(0.0, neph_vec3_dot(line.direction, inward)) / M_PI;
    line.weight = wanted /
                  (0.5 * wanted + 0.5 * neph_lamp_direction_per_sr(scene, at_m, line.direction));
    return line;
}

/* All light of a point light in a white medium leaves it: scattered light crosses a sphere around
 * it with the power pi 4 pi R^2 times the mean radiance of lines that enter by the cosine law. A
 * ball that reflects all light changes nothing. */
static void assert_conserves(struct neph_phase phase, double extinction_per_m, bool ball)
{
    const double radius_m = 2.0; /* as in random_line() */
    struct neph_medium block = make_homogeneous(extinction_per_m,
                                                (struct neph_bounds){{-1, -1, -1}, {1, 1, 1}});
    block.phase = phase;
    struct neph_scene scene = make_lamplit(block, (struct neph_vec3){0.3, -0.2, 0.1});
    struct neph_solid white_ball = make_sphere(-0.4, 0.3, 0.2, 0.3);
    white_ball.albedo = white;
    scene.scattering = NEPH_SCATTERING_MULTIPLE;
    scene.solids = &white_ball;
    scene.solid_count = ball;
    struct neph_tracker *tracker;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_tracker_create(&scene, &tracker, &diag), &diag);
    struct neph_tracking_cost cost = {0, 0};
    struct estimate straight = {{0}, {0}}, scattered = {{0}, {0}};
    const int samples = neph_test_paths(neph_test_by_day(120000, 1000000));
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(4, 0, (uint64_t)n);
        const struct neph_phase isotropic = {NEPH_PHASE_ISOTROPIC, 0.0};
        const struct neph_vec3 up = {0, 0, 1};
        const struct neph_vec3 out = neph_phase_sample(&isotropic, up, &random);
        const bool hits = neph_scene_hit(&scene, scene.lights[0].position_m, out).solid;
        const struct neph_rgb depth = neph_scene_optical_depth(&scene, scene.lights[0].position_m,
                                                               out, 0.0, INFINITY);
        add_path(&straight, make_grey(hits ? 0.0 : 4.0 * M_PI * exp(-depth.r)));
        const struct line line = random_line(&scene, out, &random);
        const struct neph_view view = neph_view_create(&scene, neph_vec3_scale(out, radius_m),
                                                       line.direction);
        const struct neph_path_light light = neph_path_trace(&scene, tracker, &view, NULL, &random,
                                                             &cost);
        const struct neph_rgb all = neph_rgb_add(neph_rgb_add(light.volume, light.surface),
                                                 view.unscattered);
        add_path(&scattered,
                 neph_rgb_scale(all, line.weight * 4.0 * M_PI * M_PI * radius_m * radius_m));
    }
    finish(&straight, samples);
    finish(&scattered, samples);
    neph_tracker_destroy(tracker);
    print_message("of 4 pi: straight %.4f, scattered %.4f +- %.4f\n",
                  straight.mean[0] / (4.0 * M_PI), scattered.mean[0] / (4.0 * M_PI),
                  scattered.error[0] / (4.0 * M_PI));
    neph_assert_close(straight.mean[0] + scattered.mean[0], 4.0 * M_PI, 0.0,
                      4.5 * hypot(straight.error[0], scattered.error[0]));
    assert_true(scattered.error[0] < neph_test_noise(0.08) * 4.0 * M_PI);
}

static struct estimate trace_middle_ray(const struct neph_scene *scene, int samples, uint64_t seed)
{
    struct neph_tracker *tracker;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    struct neph_tracking_cost cost = {0, 0};
    const struct neph_view view = neph_view_create(scene, scene->camera_keys[0].position_m,
                                                   (struct neph_vec3){0, 0, -1});
    struct neph_flight flight;
    const struct neph_ray ray = {view.origin_m, view.direction, view.hit.t_m};
    neph_flight_init(&flight, scene, &ray);
    struct estimate sums = {{0}, {0}};
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(9, seed, (uint64_t)n);
        add_path(&sums, neph_path_trace(scene, tracker, &view, &flight, &random, &cost).volume);
    }
    finish(&sums, samples);
    neph_tracker_destroy(tracker);
    return sums;
}

/* 4.5 standard errors, which are never above a twentieth of the value. */
static void test_paths_find_lights_near_rays(void **state)
{
    const int samples = neph_test_paths(20000);
    for (int i = 0; i < NEAR_LAMPS; i++) {
        struct test_scene test;
        const struct neph_scene *scene = near_lamp_stage(&test, &near_lamps[i]);
        const double truth =
            neph_transport_ray(scene, test.key.position_m, (struct neph_vec3){0, 0, -1}).volume.g;
        const struct estimate found = trace_middle_ray(scene, samples, (uint64_t)i);
        print_message("%s: exact %.5g, paths %.5g +- %.2g\n", near_lamps[i].name, truth,
                      found.mean[1], found.error[1]);
        neph_assert_close(found.mean[1], truth, 0.0, 4.5 * found.error[1]);
        assert_true(found.error[1] < neph_test_noise(0.05 * truth) && found.error[1] > 0.0);
    }
}

/* The density of the fog goes to 0 at the light, 1e-6 m from the ray: sampling by 1 / d^2 places
 * nearly all points where there is no fog. */
static void test_paths_find_the_fog_around_a_clear_place(void **state)
{
    struct test_scene test;
    const struct near_lamp lamp = {.light_m = {0, 1e-6, 0}};
    struct neph_scene *scene = near_lamp_stage(&test, &lamp);
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create((int[]){3, 3, 3}, (struct neph_vec3){-1, -1, -1},
                                    (struct neph_vec3){1, 1, 1}, &grid, &diag),
                   &diag);
    for (int i = 0; i < 27; i++)
        grid->values[i] = i == 13 ? 0.0f : 1.0f;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    scene->media[0] = make_voxels(0.5, grid);
    const double truth =
        neph_transport_ray(scene, test.key.position_m, (struct neph_vec3){0, 0, -1}).volume.g;
    const struct estimate found = trace_middle_ray(scene, neph_test_paths(20000), 77);
    print_message("clear place: exact %.5g, paths %.5g +- %.2g\n", truth, found.mean[1],
                  found.error[1]);
    neph_assert_close(found.mean[1], truth, 0.0, 4.5 * found.error[1]);
    assert_true(found.error[1] < neph_test_noise(0.05 * truth));
    neph_grid_destroy(grid);
}

static void test_white_media_keep_all_lamplight(void **state)
{
    assert_conserves((struct neph_phase){NEPH_PHASE_ISOTROPIC, 0.0}, 0.7, false);
    assert_conserves((struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.4}, 2.0, true);
    assert_conserves((struct neph_phase){NEPH_PHASE_RAYLEIGH, 0.0}, 4.0, false);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Light emitted by media: exact rays against closed forms and the definition's sum, and the path
 * tracer against both; Kirchhoff's furnace, in which media of any albedo are invisible.
 *
 * Tolerances of estimates: 4.5 standard errors of the estimate itself (wrong once in 150 000 for a
 * normal variable; seeds are fixed), plus 1e-12 for rounding where there is no noise.
 */
#include "tests/scene_builders.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "truth/path.h"
#include "truth/transport.h"

static const double sigmas = 4.5;
static const struct neph_vec3 ahead = {0, 0, -1};
static const struct neph_vec3 eye_m = {0.3, 0.1, 40};
static const struct neph_vec3 half_m = {1, 1, 1}; /* of a cube */

static double channel_of(struct neph_rgb rgb, int channel)
{
    return channel == 0 ? rgb.r : channel == 1 ? rgb.g : rgb.b;
}

/* ---- media ---- */

/* 2 m of the ray ahead are between the planes z and z + 2. */
static struct neph_medium plate(double extinction_per_m, double z_m, struct neph_rgb albedo,
                                struct neph_rgb emission)
{
    struct neph_medium medium = make_homogeneous(
        extinction_per_m, (struct neph_bounds){{-20, -20, z_m}, {20, 20, z_m + 2.0}});
    medium.albedo = albedo;
    medium.emission_w_per_m2_sr = emission;
    return medium;
}

static struct neph_scene dark_scene(enum neph_scattering scattering)
{
    return (struct neph_scene){.scattering = scattering};
}

static struct neph_scene *add(struct neph_scene *scene, struct neph_medium medium)
{
    scene->media[scene->medium_count++] = medium;
    return scene;
}

/* ---- radiance of emission -------- */

static void test_glow(void **state)
{
    struct neph_medium medium = plate(1, 0, (struct neph_rgb){0, 0.25, 1}, make_grey(8));
    medium.extinction_color = (struct neph_rgb){1, 2, 1};
    const struct neph_rgb glow = neph_medium_glow(&medium);
    assert_true(glow.r == 8.0 && glow.g == 6.0 && glow.b == 0.0);
    assert_true(neph_medium_emits(&medium));
    medium.extinction_color = (struct neph_rgb){0, 0, 1}; /* white in the only channel with
                                                             extinction */
    assert_false(neph_medium_emits(&medium));
}

/* ---- exact rays ---- */

/* glow * (1 - e^-tau) per channel, at optical depths 2e-10 to 2e4, with any mode of scattering. */
static void test_one_plate(void **state)
{
    const struct neph_rgb albedo = {0, 0.5, 0.9}, emission = {1, 2, 3};
    for (double extinction_per_m = 1e-10; extinction_per_m < 1e5; extinction_per_m *= 10.0)
        for (int s = NEPH_SCATTERING_NONE; s <= NEPH_SCATTERING_SINGLE; s++) {
            struct neph_scene scene = dark_scene((enum neph_scattering)s);
            add(&scene, plate(extinction_per_m, 0, albedo, emission));
            scene.media[0].extinction_color = (struct neph_rgb){0.5, 1, 2};
            const struct neph_ray_light light = neph_transport_ray(&scene, eye_m, ahead);
            for (int j = 0; j < 3; j++) {
                const double depth = 2.0 * extinction_per_m * (j == 0 ? 0.5 : j);
                const double expected = (1.0 - channel_of(albedo, j)) * channel_of(emission, j) *
                                        -expm1(-depth);
                /* Roundings of the length, 2 m as the difference of 40 and 38, and of the remaining
                 * factors. */
                neph_assert_close(channel_of(light.radiance, j), expected, 1e-14, 0.0);
                neph_assert_close(channel_of(light.volume, j), expected, 1e-14, 0.0);
            }
        }
}

/* Plates in a row with different emission: each is attenuated by the plates in front of it, even
 * with an optical depth of 60, or of 700. Overlapping ones share the extinction. */
static void test_plates_that_differ(void **state)
{
    for (double front_per_m = 0.05; front_per_m < 400.0; front_per_m *= 2.0) {
        struct neph_scene scene = dark_scene(NEPH_SCATTERING_NONE);
        add(&scene, plate(front_per_m, 4, make_grey(0), make_grey(0)));
        add(&scene, plate(0.5, 0, make_grey(0.25), make_grey(4)));
        add(&scene, plate(1.5, 0, make_grey(0), make_grey(1)));
        add(&scene, plate(20.0, -8, make_grey(0), make_grey(7)));
        const double front = 2.0 * front_per_m, middle = 4.0, glow = (0.5 * 3.0 + 1.5 * 1.0) / 2.0;
        const double expected = exp(-front) *
                                (glow * -expm1(-middle) + exp(-middle) * 7.0 * -expm1(-40.0));
        const struct neph_ray_light light = neph_transport_ray(&scene, eye_m, ahead);
        /* 1e-12, or four roundings of the exponent. */
        neph_assert_close(light.volume.g, expected, 1e-12 + 4.0 * 0x1p-53 * front, 0.0);
        assert_true(light.quadrature_error <= 1e-10 * expected);
    }
}

/* Infinite: 1 where it is opaque, otherwise by its whole optical depth. */
static void test_fog_without_end(void **state)
{
    struct neph_scene scene = dark_scene(NEPH_SCATTERING_NONE);
    add(&scene, make_height_fog(0.1, 0.2));
    scene.media[0].albedo = make_grey(0.5);
    scene.media[0].emission_w_per_m2_sr = make_grey(2);
    const struct neph_vec3 up = {0, 1, 0};
    for (int quadrature = 0; quadrature < 2; quadrature++) {
        neph_assert_close(neph_transport_ray(&scene, (struct neph_vec3){0}, ahead).volume.b, 1.0,
                          1e-12, 0.0);
        neph_assert_close(neph_transport_ray(&scene, (struct neph_vec3){0}, up).volume.b,
                          -expm1(-0.5), 1e-12, 0.0);
        add(&scene, plate(1, 30, make_grey(0), make_grey(5))); /* behind both, invisible to both */
        scene.media[1].bounds.min_m.y = 1.0;
    }
}

/* Sunlight scattered once and emitted light add up. */
static void test_the_sun_adds(void **state)
{
    struct neph_scene scene = make_sunny(plate(0.7, 0, make_grey(0.5), make_grey(0)),
                                         (struct neph_vec3){0.3, 0.2, 0.9});
    const struct neph_ray_light scattered = neph_transport_ray(&scene, eye_m, ahead);
    scene.media[0].emission_w_per_m2_sr = make_grey(4);
    const struct neph_ray_light both = neph_transport_ray(&scene, eye_m, ahead);
    assert_true(scattered.volume.r > 0.0);
    neph_assert_close(both.volume.r, scattered.volume.r + 2.0 * -expm1(-1.4), 1e-14, 0.0);
}

/* ---- random scenes -- */

static struct neph_medium random_emitter(uint64_t *seed)
{
    const double kind = neph_test_uniform(seed, 0, 3);
    const double extinction_per_m = exp(neph_test_uniform(seed, -3, 1));
    const struct neph_vec3 center_m = random_point(seed, 2.0);
    struct neph_medium medium = make_height_fog(0.2 * extinction_per_m,
                                                neph_test_uniform(seed, 0.1, 1));
    if (kind < 1.0)
        medium = make_blob(extinction_per_m, center_m, neph_test_uniform(seed, 0.3, 2));
    else if (kind < 2.0)
        medium = make_homogeneous(
            extinction_per_m,
            (struct neph_bounds){neph_vec3_sub(center_m, half_m), neph_vec3_add(center_m, half_m)});
    medium.albedo = (struct neph_rgb){neph_test_uniform(seed, 0, 1), neph_test_uniform(seed, 0, 1),
                                      neph_test_uniform(seed, 0, 1)};
    medium.extinction_color = (struct neph_rgb){1, neph_test_uniform(seed, 0.2, 2), 0.5};
    medium.emission_w_per_m2_sr = make_grey(neph_test_uniform(seed, 0, 5));
    return medium;
}

/* The definition by the midpoint rule over [0, end]. */
static double brute_force(const struct neph_scene *scene, struct neph_vec3 origin_m,
                          struct neph_vec3 direction, double end_m, int channel)
{
    enum { STEPS = 20000 };
    const double step_m = end_m / STEPS;
    double sum = 0.0, depth = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const struct neph_vec3 p = neph_vec3_along(origin_m, direction, (i + 0.5) * step_m);
        double extinction = 0.0, emitted = 0.0;
        for (int m = 0; m < scene->medium_count; m++) {
            const struct neph_medium *medium = &scene->media[m];
            const double own = step_m * channel_of(medium->extinction_color, channel) *
                               neph_medium_extinction_per_m(medium, p);
            extinction += own;
            emitted += own * (1.0 - channel_of(medium->albedo, channel)) *
                       channel_of(medium->emission_w_per_m2_sr, channel);
        }
        sum += emitted * exp(-depth - 0.5 * extinction);
        depth += extinction;
    }
    return sum;
}

/* Three media of any kind and colour in front of a wall. A midpoint step with a face of a box has
 * an error of at most the step's own contribution; there are six such steps. */
static void test_random_scenes_against_brute_force(void **state)
{
    for (uint64_t start = 1; start <= 60; start++) {
        uint64_t seed = start;
        struct neph_solid wall = make_box(-100, -100, -30, 100, 100, -20);
        struct neph_scene scene = dark_scene(NEPH_SCATTERING_NONE);
        scene.solid_count = 1;
        scene.solids = &wall;
        for (int m = 0; m < 3; m++)
            add(&scene, random_emitter(&seed));
        const struct neph_vec3 from_m = {neph_test_uniform(&seed, -1, 1),
                                         neph_test_uniform(&seed, -1, 1), 10};
        const struct neph_ray_light light = neph_transport_ray(&scene, from_m, ahead);
        for (int j = 0; j < 3; j++) {
            const double summed = brute_force(&scene, from_m, ahead, 30.0, j);
            if (!(fabs(summed - channel_of(light.volume, j)) <= 6.0 * 5.0 * 2.0 * M_E * 30.0 / 2e4))
                print_error("seed %llu\n", (unsigned long long)start);
            neph_assert_close(channel_of(light.volume, j), summed, 0.0,
                              6.0 * 5.0 * 2.0 * M_E * 30.0 / 2e4);
        }
    }
}

/* ---- path tracer -------- */

struct estimate {
    struct neph_rgb mean, error, order1;
};

static struct estimate estimate(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                struct neph_vec3 direction, int all_samples, bool flights)
{
    const int samples = neph_test_paths(all_samples);
    struct neph_diag diag = {0};
    struct neph_tracker *tracker;
    struct neph_tracking_cost cost = {0, 0};
    struct neph_flight flight;
    neph_assert_ok(neph_tracker_create(scene, &tracker, &diag), &diag);
    const struct neph_view view = neph_view_create(scene, origin_m, direction);
    const struct neph_ray ray = {origin_m, direction, view.hit.t_m};
    neph_flight_init(&flight, scene, &ray);
    struct neph_rgb sum = {0}, squares = {0}, order1 = {0};
    for (int n = 0; n < samples; n++) {
        struct neph_random random = neph_random_stream(7, 0, (uint64_t)n);
        const struct neph_path_light light = neph_path_trace(
            scene, tracker, &view, flights ? &flight : NULL, &random, &cost);
        const struct neph_rgb all = neph_rgb_add(view.unscattered,
                                                 neph_rgb_add(light.volume, light.surface));
        sum = neph_rgb_add(sum, all);
        squares = neph_rgb_add(squares, neph_rgb_mul(all, all));
        order1 = neph_rgb_add(order1, light.order1);
    }
    neph_tracker_destroy(tracker);
    const struct neph_rgb mean = neph_rgb_scale(sum, 1.0 / samples);
    const struct neph_rgb square = neph_rgb_scale(squares, 1.0 / samples);
    return (struct estimate){
        mean,
        {sqrt(fmax(0.0, square.r - mean.r * mean.r) / (samples - 1)),
         sqrt(fmax(0.0, square.g - mean.g * mean.g) / (samples - 1)),
         sqrt(fmax(0.0, square.b - mean.b * mean.b) / (samples - 1))},
        neph_rgb_scale(order1, 1.0 / samples),
    };
}

static void assert_estimate(const struct estimate *found, struct neph_rgb expected, double noise,
                            uint64_t seed)
{
    for (int j = 0; j < 3; j++) {
        const double mean = channel_of(found->mean, j), error = channel_of(found->error, j);
        const double truth = channel_of(expected, j);
        if (!(fabs(mean - truth) <= sigmas * error + 1e-12 * truth))
            print_error("seed %llu, channel %d\n", (unsigned long long)seed, j);
        neph_assert_close(mean, truth, 1e-12, sigmas * error);
        /* The error estimate is small enough for the test to fail. The error of equal paths is the
         * rounding of a difference of squares: sqrt((2 n + 2) epsilon / (n - 1)) of the mean, below
         * 3e-8 from 16 paths on. */
        assert_true(error <= (neph_test_noise(noise) + 3e-8) * truth);
    }
}

/* One grey medium, all depths drawn from its own table: every path has the same value. */
static void test_a_plate_without_noise(void **state)
{
    for (int s = NEPH_SCATTERING_NONE; s <= NEPH_SCATTERING_SINGLE; s++) {
        struct neph_scene scene = dark_scene((enum neph_scattering)s);
        add(&scene, plate(0.8, 0, (struct neph_rgb){0, 0.5, 0.9}, (struct neph_rgb){1, 2, 3}));
        const struct estimate found = estimate(&scene, eye_m, ahead, 16, true);
        assert_estimate(&found, neph_transport_ray(&scene, eye_m, ahead).radiance, 0.0, 0);
    }
}

/* Any three media, with and without a sun with single scattering; with tables of the first flight
 * and without. Order 1 is only sunlight. */
static void test_paths_against_exact(void **state)
{
    for (uint64_t start = 1; start <= 24; start++) {
        uint64_t seed = start;
        const bool is_sunny = start % 3 > 0;
        struct neph_scene scene = dark_scene(start % 3 ? NEPH_SCATTERING_SINGLE
                                                       : NEPH_SCATTERING_NONE);
        scene.sun = (struct neph_sun){is_sunny, random_direction(&seed), {3, 2, 1}};
        for (int m = 0; m < 3; m++)
            add(&scene, random_emitter(&seed));
        const struct neph_vec3 from_m = {neph_test_uniform(&seed, -1, 1),
                                         neph_test_uniform(&seed, -1, 1), 10};
        const struct neph_ray_light light = neph_transport_ray(&scene, from_m, ahead);
        const struct estimate found = estimate(&scene, from_m, ahead, 20000, start % 2 == 0);
        assert_estimate(&found, light.radiance, 0.05, start);
        assert_true(is_sunny || found.order1.g == 0.0);
    }
}

/* ---- Kirchhoff's furnace ---- */

/* Media with albedos from 0 to 1 whose emission matches the surroundings, and a white ball. */
static struct neph_scene furnace(struct neph_solid *ball)
{
    const struct neph_rgb surround = {1, 2, 3};
    *ball = make_sphere(0, 0, -3, 1);
    ball->albedo = white;
    struct neph_scene scene = dark_scene(NEPH_SCATTERING_MULTIPLE);
    scene.environment_light = true;
    scene.background_w_per_m2_sr = surround;
    scene.solid_count = 1;
    scene.solids = ball;
    add(&scene, plate(1.5, 0, (struct neph_rgb){0.5, 0, 0.9}, surround));
    add(&scene, make_blob(2.0, (struct neph_vec3){0.3, 0.2, -1}, 0.8));
    scene.media[0].extinction_color = (struct neph_rgb){1, 0.3, 2};
    scene.media[0].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.6};
    scene.media[1].albedo = (struct neph_rgb){0.3, 1, 0.7};
    scene.media[1].emission_w_per_m2_sr = (struct neph_rgb){1, 0, 3}; /* green needs no emission */
    return scene;
}

static void test_furnace_is_exact(void **state)
{
    char reason[100] = "";
    struct neph_solid ball;
    struct neph_scene scene = furnace(&ball);
    assert_true(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    const struct neph_ray_light light = neph_transport_ray(&scene, eye_m, ahead);
    assert_true(light.radiance.r == 1.0 && light.radiance.g == 2.0 && light.radiance.b == 3.0);
    neph_assert_close(light.volume.b, 3.0 * (1.0 - light.transmittance.b), 1e-14, 0.0);
    scene.media[1].emission_w_per_m2_sr.r = 0.99;
    assert_false(neph_transport_is_exact(&scene, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "furnace"));
}

static void test_paths_in_the_furnace(void **state)
{
    struct neph_solid ball;
    const struct neph_scene scene = furnace(&ball);
    const struct neph_vec3 directions[] = {{0, 0, -1}, {0.05, 0.02, -1}, {-0.3, 0.1, -1}};
    for (size_t i = 0; i < COUNT(directions) * 2; i++) {
        const struct neph_vec3 direction = neph_vec3_normalize(directions[i / 2]);
        const struct estimate found = estimate(&scene, (struct neph_vec3){0.3, 0.1, 5}, direction,
                                               20000, i % 2 == 0);
        assert_estimate(&found, scene.background_w_per_m2_sr, 0.02, i);
    }
}

/* Light is additive: the media's emission in the dark, and the surroundings' light with cold media,
 * add up to the furnace. Emitted light by itself lights the ball. */
static void test_halves_of_the_furnace(void **state)
{
    struct neph_solid ball;
    const struct neph_scene whole = furnace(&ball);
    struct neph_scene dark = whole, cold = whole;
    dark.background_w_per_m2_sr = make_grey(0);
    cold.media[0].emission_w_per_m2_sr = cold.media[1].emission_w_per_m2_sr = make_grey(0);
    const struct neph_vec3 from_m = {0.3, 0.1, 5};
    const struct estimate emitted = estimate(&dark, from_m, ahead, 40000, true);
    const struct estimate left = estimate(&cold, from_m, ahead, 40000, true);
    for (int j = 0; j < 3; j++) {
        const double error = hypot(channel_of(emitted.error, j), channel_of(left.error, j));
        const double sum = channel_of(emitted.mean, j) + channel_of(left.mean, j);
        assert_true(channel_of(emitted.mean, j) > 0.1);
        assert_true(channel_of(left.mean, j) > 0.02);
        assert_true(error < neph_test_noise(0.02)); /* the test can fail */
        neph_assert_close(sum, 1.0 + j, 0.0, sigmas * error);
    }
    dark.medium_count = 1; /* behind the camera: it lights the visible side of the ball */
    dark.media[0].bounds = (struct neph_bounds){{-20, -20, 6}, {20, 20, 8}};
    assert_true(estimate(&dark, from_m, ahead, 4000, true).mean.r > 0.1);
    dark.scattering = NEPH_SCATTERING_SINGLE; /* visible, but it does not light surfaces */
    assert_true(estimate(&dark, from_m, ahead, 4000, true).mean.r == 0.0);
}

#include "tests/main.h"

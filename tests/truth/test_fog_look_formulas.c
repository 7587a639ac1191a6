/* SPDX-License-Identifier: MIT
 *
 * The non-physical models of height fog against the engines' published formulas in a second
 * transcription, against quadrature where a formula stands for an integral, and at points where the
 * published code divides by 0 or overflows. The required accuracy is 1e-6; the measured one is
 * printed.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "truth/fog_look.h"
#include "truth/transport.h"

static const double ln2 = 0.693147180559945309417232121458;

struct view {
    struct neph_vec3 eye_m, direction;
    double length_m;
};

/* ---- scenes ---------------------------------------------------------------------------------- */

static struct neph_fog_look plain_look(void)
{
    const struct neph_fog_look all_off = {
        .present = true, .inscattering_w_per_m2_sr = {0.5, 0.6, 0.7}, .directional_exponent = 4.0};
    return neph_fog_look_only(&all_off, 0);
}

/* With Unreal's values, one layer each. */
static struct neph_scene foggy(double density, double falloff, double height_m)
{
    const struct neph_unreal_fog ui = {density, falloff, height_m};
    struct neph_scene scene = make_sunny(make_height_fog(0.0, 0.0),
                                         (struct neph_vec3){0.3, 0.4, -0.8});
    scene.media[0].layers[0] = neph_fog_layer_from_unreal(&ui);
    scene.background_w_per_m2_sr = (struct neph_rgb){0.2, 0.3, 0.9};
    scene.fog_look = plain_look();
    return scene;
}

static void add_layer(struct neph_scene *scene, double density, double falloff, double height_m)
{
    const struct neph_unreal_fog ui = {density, falloff, height_m};
    struct neph_medium *fog = &scene->media[0];
    fog->layers[fog->layer_count++] = neph_fog_layer_from_unreal(&ui);
}

static struct neph_fog_look_light seen(const struct neph_scene *scene, enum neph_fog_model model,
                                       const struct view *view)
{
    return neph_fog_look_ray(scene, &scene->fog_look, model, view->eye_m, view->direction,
                             view->length_m);
}

static struct view some_view(uint64_t *seed)
{
    return (struct view){
        .eye_m = {neph_test_uniform(seed, -50, 50), neph_test_uniform(seed, -40, 120),
                  neph_test_uniform(seed, -50, 50)},
        .direction = random_direction(seed),
        .length_m = pow(10.0, neph_test_uniform(seed, -1, 3.3)),
    };
}

/* Each control is set in every second look. */
static struct neph_fog_look some_look(uint64_t *seed)
{
    const struct neph_fog_look full = {
        .present = true,
        .inscattering_w_per_m2_sr = {neph_test_uniform(seed, 0, 2), neph_test_uniform(seed, 0, 2),
                                     neph_test_uniform(seed, 0, 2)},
        .sky_light = make_grey(neph_test_uniform(seed, 0, 1)),
        .start_distance_m = neph_test_uniform(seed, 0, 60),
        .end_distance_m = neph_test_uniform(seed, 60, 1500),
        .cutoff_distance_m = neph_test_uniform(seed, 100, 3000),
        .max_opacity = neph_test_uniform(seed, 0, 1),
        .volumetric_fog_distance_m = neph_test_uniform(seed, 0, 60),
        .observer_height_max_m = neph_test_uniform(seed, 0, 100),
        .directional_w_per_m2_sr = {neph_test_uniform(seed, 0, 3), neph_test_uniform(seed, 0, 3),
                                    neph_test_uniform(seed, 0, 3)},
        .directional_exponent = neph_test_uniform(seed, 0, 64),
        .directional_start_m = neph_test_uniform(seed, 0, 100),
    };
    return neph_fog_look_only(&full, (unsigned)neph_test_random(seed) & NEPH_FOG_CONTROLS_ALL);
}

/* ---- the engines' formulas, in their own units and order ------------------------------------- */

struct engine_fog {
    double transmittance;
    double light[3];
};

static double clamped(double x)
{
    return fmin(1.0, fmax(0.0, x));
}

/* The article's listing, receiver by receiver; in metres. `end` is Unreal 5's. */
static struct engine_fog as_unreal(const struct neph_scene *scene, const struct view *view)
{
    const struct neph_fog_look *look = &scene->fog_look;
    const double observer_y = fmin(view->eye_m.y, look->observer_height_max_m);
    struct neph_vec3 receiver = neph_vec3_scale(view->direction, view->length_m);
    receiver.y += view->eye_m.y - observer_y;
    const double distance = sqrt(neph_vec3_dot(receiver, receiver));
    const struct neph_vec3 to_receiver = neph_vec3_scale(receiver, 1.0 / distance);
    const double exclude = fmax(look->start_distance_m, look->volumetric_fog_distance_m);
    const double level = hypot(receiver.x, receiver.z); /* distance over ground */
    const double end = look->end_distance_m > 0.0 && level > look->end_distance_m
                           ? distance * look->end_distance_m / level
                           : distance;
    const double start_y = observer_y + exclude / distance * receiver.y;
    const double rise = (end - exclude) / distance * receiver.y, ray = end - exclude;
    double shared = 0.0;
    for (int l = 0; l < scene->media[0].layer_count; l++) {
        const struct neph_unreal_fog ui = neph_fog_layer_to_unreal(&scene->media[0].layers[l]);
        const double density = ui.fog_density / 10.0, falloff = ui.fog_height_falloff / 10.0;
        const double exponent = fmax(-127.0, falloff * (start_y - ui.fog_height_m));
        const double f = fmax(-127.0, falloff * rise);
        const double mean = fabs(f) > 0.01 ? (1.0 - pow(2.0, -f)) / f
                                           : log(2.0) - 0.5 * pow(log(2.0), 2.0) * f;
        shared += density * pow(2.0, -exponent) * mean;
    }
    struct engine_fog fog = {fmax(clamped(pow(2.0, -shared * ray)), 1.0 - look->max_opacity), {0}};
    double glow = pow(clamped(neph_vec3_dot(to_receiver, scene->sun.direction)),
                      look->directional_exponent);
    glow *= 1.0 - clamped(pow(2.0, -shared * fmax(ray - look->directional_start_m, 0.0)));
    if (look->cutoff_distance_m > 0.0 && distance > look->cutoff_distance_m) {
        fog.transmittance = 1.0;
        glow = 0.0;
    }
    const double *own = &look->inscattering_w_per_m2_sr.r, *sky = &look->sky_light.r,
                 *background = &scene->background_w_per_m2_sr.r,
                 *directional = &look->directional_w_per_m2_sr.r;
    for (int c = 0; c < 3; c++)
        fog.light[c] = (own[c] + sky[c] * background[c]) * (1.0 - fog.transmittance) +
                       directional[c] * glow;
    return fog;
}

static struct engine_fog as_filament(const struct neph_scene *scene, const struct view *view)
{
    const struct neph_fog_look *look = &scene->fog_look;
    const struct neph_fog_layer *layer = &scene->media[0].layers[0];
    const double d = view->length_m;
    struct engine_fog fog = {1.0, {0}};
    if (d < look->start_distance_m ||
        (look->cutoff_distance_m > 0.0 && d > look->cutoff_distance_m))
        return fog;
    const double at_eye = -layer->falloff_per_m * (view->eye_m.y - layer->height_m);
    const double here = layer->extinction_per_m * exp(at_eye);
    const double fh = layer->falloff_per_m * view->direction.y * d;
    double at_one_meter = here;
    if (fabs(fh) > 0.00125)
        at_one_meter = (here - layer->extinction_per_m * exp(at_eye - fh)) / fh;
    const double through = exp(-at_one_meter * fmax(d - look->start_distance_m, 0.0));
    const double opacity = fmin(1.0 - through, look->max_opacity);
    const double amount = fmax(neph_vec3_dot(view->direction, scene->sun.direction), 0.0);
    const double glow = pow(amount, look->directional_exponent) *
                        (1.0 - exp(-at_one_meter * fmax(d - look->directional_start_m, 0.0)));
    const double *own = &look->inscattering_w_per_m2_sr.r, *sky = &look->sky_light.r,
                 *background = &scene->background_w_per_m2_sr.r,
                 *directional = &look->directional_w_per_m2_sr.r;
    fog.transmittance = fmax(through, 1.0 - look->max_opacity); /* 1 - opacity, with all digits */
    for (int c = 0; c < 3; c++)
        fog.light[c] = (own[c] + sky[c] * background[c]) * opacity + directional[c] * glow;
    return fog;
}

typedef struct engine_fog engine_function(const struct neph_scene *scene, const struct view *view);

/* The listing's 1 - T is rounded to 2^-53 of 1, and so is its light. */
static void check_against(engine_function *engine, enum neph_fog_model model,
                          const struct neph_scene *scene, const struct view *view, double *worst)
{
    const struct engine_fog expected = engine(scene, view);
    const struct neph_fog_look_light actual = seen(scene, model, view);
    const double *volume = &actual.volume.r, asked = 1e-6, rounding = 1e-13;
    if (expected.transmittance > 1e-280) {
        neph_assert_close(actual.transmittance, expected.transmittance, asked, 0.0);
        *worst = fmax(*worst, fabs(actual.transmittance / expected.transmittance - 1.0));
    }
    neph_assert_close(actual.opacity, 1.0 - expected.transmittance, asked, rounding);
    for (int c = 0; c < 3; c++) {
        neph_assert_close(volume[c], expected.light[c], asked, rounding);
        if (expected.light[c] > 1e-3)
            *worst = fmax(*worst, fabs(volume[c] / expected.light[c] - 1.0));
    }
}

/* A fog with some controls, and a view: one of five in turn. */
static struct neph_scene some_fog(int trial, uint64_t *seed, bool two_layers, struct view *view)
{
    struct neph_scene scene = foggy(pow(10.0, neph_test_uniform(seed, -4, 0.3)),
                                    neph_test_uniform(seed, 0.001, 3),
                                    neph_test_uniform(seed, -20, 20));
    if (two_layers)
        add_layer(&scene, neph_test_uniform(seed, 0, 1), neph_test_uniform(seed, 0.001, 1),
                  neph_test_uniform(seed, -20, 20));
    scene.fog_look = some_look(seed);
    *view = some_view(seed);
    if (trial % 5 == 0)
        view->direction = neph_vec3_normalize(
            (struct neph_vec3){view->direction.x, 1e-5 * view->direction.y, view->direction.z});
    return scene;
}

static void test_unreal_is_what_its_listing_says(void **state)
{
    double worst = 0.0;
    for (int trial = 0; trial < neph_test_paths(20000); trial++) {
        uint64_t seed = 100 + (uint64_t)trial;
        struct view view;
        const struct neph_scene scene = some_fog(trial, &seed, trial % 2, &view);
        check_against(as_unreal, NEPH_FOG_UNREAL, &scene, &view, &worst);
    }
    printf("Unreal's listing: off by %.1e at most\n", worst);
}

static void test_filament_is_what_its_shader_says(void **state)
{
    double worst = 0.0;
    for (int trial = 0; trial < neph_test_paths(20000); trial++) {
        uint64_t seed = 900 + (uint64_t)trial;
        struct view view;
        const struct neph_scene scene = some_fog(trial, &seed, false, &view);
        check_against(as_filament, NEPH_FOG_FILAMENT, &scene, &view, &worst);
    }
    printf("Filament's shader: off by %.1e at most\n", worst);
}

/* ---- part by part ---------------------------------------------------------------------------- */

/* d 2^(-f (y - h)), in Unreal's centimetres and thousandths; the exponent is limited to -127. */
static void test_density_is_unreals(void **state)
{
    for (int trial = 0; trial < 1000; trial++) {
        uint64_t seed = 40 + (uint64_t)trial;
        const struct neph_unreal_fog ui = {neph_test_uniform(&seed, 0, 4),
                                           neph_test_uniform(&seed, 0, 2),
                                           neph_test_uniform(&seed, -100, 100)};
        const struct neph_fog_layer layer = neph_fog_layer_from_unreal(&ui);
        const struct neph_unreal_layer unreal = neph_unreal_layer_of(&layer);
        const double y_m = neph_test_uniform(&seed, -500, 500);
        const double exponent = ui.fog_height_falloff / 1000 * 100 * (y_m - ui.fog_height_m);
        const double per_cm = ui.fog_density / 1000 * pow(2.0, -fmax(-127.0, exponent));
        neph_assert_close(neph_unreal_density_per_m(&unreal, y_m), 100 * per_cm, 1e-12, 0.0);
    }
    const struct neph_unreal_layer deep = {3.0, 0.2, 0.0};
    neph_assert_close(neph_unreal_density_per_m(&deep, -1000.0), 3.0 * 0x1p127, 0.0, 0.0);
}

/* L is ln 2 times the mean of 2^-(F t), by Simpson's rule, and near 0 within the cubic term that
 * its series omits; the jump at the seam has this size. */
static void test_mean_is_ln2_times_the_mean(void **state)
{
    const double exponents[] = {-120, -30,  -3,    -0.2, -0.011, -0.01, -1e-3, 0,
                                1e-3, 0.01, 0.011, 0.2,  3,      30,    120};
    for (size_t i = 0; i < sizeof(exponents) / sizeof(exponents[0]); i++) {
        const double f = exponents[i];
        const int steps = 20000;
        double sum = 0.0;
        for (int s = 0; s <= steps; s++)
            sum += (s == 0 || s == steps ? 1.0 : s % 2 ? 4.0 : 2.0) * exp2(-f * s / steps);
        const double mean = sum / (3.0 * steps);
        const double left_out = fabs(f) <= 0.01 ? pow(ln2 * f, 2.0) / 6.0 * 1.01 : 0.0;
        neph_assert_close(neph_unreal_mean(f), ln2 * mean, left_out + 1e-9, 0.0);
    }
    const double jump = neph_unreal_mean(nextafter(0.01, 1.0)) / neph_unreal_mean(0.01) - 1.0;
    neph_assert_close(jump, pow(ln2 * 0.01, 2.0) / 6.0, 0.01, 0.0);
    neph_assert_close(neph_unreal_mean(-1000.0), neph_unreal_mean(-127.0), 0.0, 0.0);
}

/* A start distance equals a camera further on, and nearer points have no fog. */
static void test_a_start_is_a_camera_further_on(void **state)
{
    for (int trial = 0; trial < 1000; trial++) {
        uint64_t seed = 70 + (uint64_t)trial;
        struct neph_scene scene = foggy(0.3, 0.4, 5.0);
        const struct view view = some_view(&seed);
        const double start_m = neph_test_uniform(&seed, 1, 300);
        const struct view further = {neph_vec3_along(view.eye_m, view.direction, start_m),
                                     view.direction, view.length_m - start_m};
        const struct neph_fog_look_light moved = seen(&scene, NEPH_FOG_UNREAL, &further);
        for (int hand_over = 0; hand_over < 2; hand_over++) {
            scene.fog_look = plain_look();
            *(hand_over ? &scene.fog_look.volumetric_fog_distance_m
                        : &scene.fog_look.start_distance_m) = start_m;
            const struct neph_fog_look_light begun = seen(&scene, NEPH_FOG_UNREAL, &view);
            neph_assert_close(begun.transmittance,
                              view.length_m > start_m ? moved.transmittance : 1.0, 1e-12, 0.0);
        }
    }
}

/* The end is a distance over ground: it does not occur straight up, and on a slope of 60 degrees it
 * is at twice the distance. */
static void test_the_end_is_over_ground(void **state)
{
    struct neph_scene scene = foggy(0.2, 0.1, 5.0);
    const struct view up = {{0, 3, 0}, {0, 1, 0}, 400.0};
    const struct view slope = {{0, 3, 0}, {0.5, sqrt(0.75), 0}, 400.0};
    const struct view half = {{0, 3, 0}, {0.5, sqrt(0.75), 0}, 200.0};
    const double up_whole = seen(&scene, NEPH_FOG_UNREAL, &up).transmittance;
    const double at_end = seen(&scene, NEPH_FOG_UNREAL, &half).transmittance;
    scene.fog_look.end_distance_m = 100.0;
    assert_true(seen(&scene, NEPH_FOG_UNREAL, &up).transmittance == up_whole);
    neph_assert_close(seen(&scene, NEPH_FOG_UNREAL, &slope).transmittance, at_end, 1e-12, 0.0);
}

/* The minimum transmittance; glow that it does not attenuate; the discontinuity at the limit. */
static void test_limits(void **state)
{
    struct neph_scene scene = foggy(2.0, 0.1, 0.0);
    struct view view = {{0, 0, 0}, scene.sun.direction, 500.0};
    const struct neph_fog_look_light whole = seen(&scene, NEPH_FOG_UNREAL, &view);
    assert_true(whole.transmittance < 0.01);
    scene.fog_look.max_opacity = 0.75;
    scene.fog_look.directional_w_per_m2_sr = white;
    const struct neph_fog_look_light held = seen(&scene, NEPH_FOG_UNREAL, &view);
    neph_assert_close(held.transmittance, 0.25, 0.0, 0.0);
    neph_assert_close(held.volume.r, 0.5 * 0.75 + (1.0 - whole.transmittance), 1e-12, 0.0);
    scene.fog_look.cutoff_distance_m = 500.0;
    view.length_m = neph_vec3_length(neph_vec3_scale(view.direction, 500.0)) * (1.0 - 1e-12);
    neph_assert_close(seen(&scene, NEPH_FOG_UNREAL, &view).transmittance, 0.25, 0.0, 0.0);
    view.length_m = 500.0 * (1.0 + 1e-12);
    const struct neph_fog_look_light cut = seen(&scene, NEPH_FOG_UNREAL, &view);
    assert_true(cut.transmittance == 1.0 && cut.opacity == 0.0 && cut.volume.r == 0.0);
}

/* ---- physics --------------------------------------------------------------------------------- */

/* With all controls off the transmittance is the medium's, except for the series of level rays; and
 * the radiance of a fog with only emission is that of engine exact. */
static void test_without_controls_it_is_physics(void **state)
{
    const double seams[] = {pow(ln2 * 0.01, 2.0) / 6.0, 0.5 * 0.00125};
    for (int trial = 0; trial < 2000; trial++) {
        uint64_t seed = 4000 + (uint64_t)trial;
        struct neph_scene scene = foggy(pow(10.0, neph_test_uniform(&seed, -4, 0.3)),
                                        neph_test_uniform(&seed, 0.001, 3), 3.0);
        scene.media[0].albedo = make_grey(0.0);
        scene.media[0].emission_w_per_m2_sr = scene.fog_look.inscattering_w_per_m2_sr;
        scene.scattering = NEPH_SCATTERING_NONE;
        struct view view = some_view(&seed);
        view.length_m = trial % 3 ? view.length_m : INFINITY;
        const double rise = scene.media[0].layers[0].falloff_per_m * fabs(view.direction.y) *
                            view.length_m;
        const double depth =
            neph_scene_optical_depth(&scene, view.eye_m, view.direction, 0.0, view.length_m).r;
        for (int model = 0; model < NEPH_FOG_MODEL_COUNT; model++) {
            const struct neph_fog_look_light fog = seen(&scene, (enum neph_fog_model)model, &view);
            const double level = rise < 0.02 ? 1.1 * seams[model] * depth : 0.0;
            if (depth < 600.0)
                neph_assert_close(fog.transmittance, exp(-depth), level + 1e-10, 0.0);
            if (isinf(view.length_m)) {
                const struct neph_ray_light exact = neph_transport_ray(&scene, view.eye_m,
                                                                       view.direction);
                neph_assert_close(fog.volume.g, exact.volume.g, 1e-10, 0.0);
                neph_assert_close(fog.transmittance, exact.transmittance.g, 1e-10, 1e-300);
            }
        }
    }
}

/* The sky's light in white fog under a uniform sky is a furnace: fog and surfaces are invisible. */
static void test_sky_light_is_a_furnace(void **state)
{
    struct neph_scene scene = foggy(0.5, 0.2, 0.0);
    scene.fog_look.inscattering_w_per_m2_sr = make_grey(0.0);
    scene.fog_look.sky_light = white;
    for (int trial = 0; trial < 200; trial++) {
        uint64_t seed = 60 + (uint64_t)trial;
        struct view view = some_view(&seed);
        view.length_m = INFINITY;
        const struct neph_fog_look_light fog = seen(&scene, NEPH_FOG_UNREAL, &view);
        neph_assert_close(fog.volume.b + fog.transmittance * 0.9, 0.9, 1e-14, 0.0);
    }
}

/* ---- where the engines' code gives NaN ------------------------------------------------------- */

static void assert_finite(const struct neph_fog_look_light *fog)
{
    assert_true(fog->transmittance >= 0.0 && fog->transmittance <= 1.0);
    assert_true(isfinite(fog->volume.r) && fog->volume.r >= 0.0);
}

/* rsqrt(0), with and without an observer elsewhere. */
static void test_nothing_lies_before_what_is_at_the_camera(void **state)
{
    for (int model = 0; model < NEPH_FOG_MODEL_COUNT; model++) {
        struct neph_scene scene = foggy(10.0, 2.0, 1000.0); /* 2^127 d is infinite as a float */
        scene.fog_look.directional_w_per_m2_sr = white;
        const struct view view = {{0, -5, 0}, {0, 0, 1}, 0.0};
        const struct neph_fog_look_light fog = seen(&scene, (enum neph_fog_model)model, &view);
        assert_true(fog.transmittance == 1.0 && fog.volume.r == 0.0);
    }
}

/* A kilometre below the fog's height, falloffs of 0.2 to 2: transmittance decreases with distance,
 * upwards, downwards and level. */
static void test_far_below_the_fog(void **state)
{
    const double falloffs[] = {0.2, 0.7, 2.0}, rises[] = {-1.0, 0.0, 1e-6, 1.0};
    for (int i = 0; i < 3 * 4 * NEPH_FOG_MODEL_COUNT; i++) {
        const struct neph_scene scene = foggy(4.0, 10.0 * falloffs[i % 3], 0.0);
        const double y = rises[i / 3 % 4];
        struct view view = {{0, -1000, 0}, {sqrt(1.0 - y * y), y, 0}, 1e-45};
        double last = 1.0;
        for (; view.length_m < 1e7; view.length_m *= 10.0) {
            const struct neph_fog_look_light fog = seen(&scene, (enum neph_fog_model)(i / 12),
                                                        &view);
            assert_finite(&fog);
            assert_true(fog.transmittance <= last);
            last = fog.transmittance;
        }
        assert_true(last < 1e-30);
    }
}

/* No falloff, no density, straight up and down, at any distance. */
static void test_zeros(void **state)
{
    const double lengths_m[] = {1e-30, 1.0, 1e6, INFINITY};
    for (int i = 0; i < 2 * 2 * 3 * 4 * NEPH_FOG_MODEL_COUNT; i++) {
        const double density = i % 2 ? 0.1 : 0.0, y = (double)(i / 4 % 3) - 1.0;
        const struct neph_scene scene = foggy(density, i / 2 % 2 ? 0.5 : 0.0, 0.0);
        const struct view view = {{0, 2, 0}, {0, y, y == 0.0}, lengths_m[i / 12 % 4]};
        const struct neph_fog_look_light fog = seen(&scene, (enum neph_fog_model)(i / 48), &view);
        assert_finite(&fog);
        if (density == 0.0)
            assert_true(fog.transmittance == 1.0 && fog.volume.g == 0.0);
    }
}

/* pow(0, 0) */
static void test_there_is_no_glow_away_from_the_sun(void **state)
{
    assert_true(neph_fog_lobe(0.0, 0.0) == 0.0 && neph_fog_lobe(-1.0, 0.0) == 0.0);
    assert_true(neph_fog_lobe(1e-300, 0.0) == 1.0 && neph_fog_lobe(1.0, 64.0) == 1.0);
    neph_assert_close(neph_fog_lobe(0.5, 3.0), 0.125, 1e-15, 0.0);
}

/* ---- controls -------------------------------------------------------------------------------- */

static void test_controls_are_switched_one_by_one(void **state)
{
    uint64_t seed = 8;
    struct neph_fog_look full = some_look(&seed);
    for (int c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        double *values = (double *)((char *)&full + neph_fog_controls()[c].at);
        values[0] = 0.5;
    }
    for (unsigned c = 0; c < NEPH_FOG_CONTROL_COUNT; c++) {
        const struct neph_fog_look one = neph_fog_look_only(&full, 1u << c);
        for (int other = 0; other < NEPH_FOG_CONTROL_COUNT; other++)
            assert_int_equal(neph_fog_control_is_on(&one, (enum neph_fog_control)other),
                             (unsigned)other == c);
    }
}

/* Controls that Filament does not have are ignored by its model. */
static void test_filament_does_not_know_all(void **state)
{
    struct neph_scene scene = foggy(0.5, 0.2, 0.0);
    const struct view view = {{0, 50, 0}, {0.6, -0.48, 0.64}, 300.0};
    const double before = seen(&scene, NEPH_FOG_FILAMENT, &view).transmittance;
    scene.fog_look.end_distance_m = 100.0;
    scene.fog_look.volumetric_fog_distance_m = 50.0;
    scene.fog_look.observer_height_max_m = 10.0;
    assert_true(seen(&scene, NEPH_FOG_FILAMENT, &view).transmittance == before);
    assert_true(seen(&scene, NEPH_FOG_UNREAL, &view).transmittance != before);
}

#include "tests/main.h"

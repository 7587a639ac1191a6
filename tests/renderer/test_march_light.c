/* SPDX-License-Identifier: MIT
 *
 * The non-physical lighting models of the ray marcher compared with their formulas in double
 * precision: octaves in closed form over a slab, Horizon light step by step.
 */
#include "tests/renderer/frames.h"

#include "renderer/octaves_fitted.h"
#include "renderer/slab_light.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "truth/slab.h"

static const int width_px = 24, height_px = 14;

/* A flat layer from y = -3 to 0 without sides, seen from above. */
static struct neph_medium *look_down_on_slab(struct test_scene *test, double extinction_per_m)
{
    test_scene_init(test);
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->key.position_m = (struct neph_vec3){0.0, 8.0, 0.0};
    test->key.look_at_m = (struct neph_vec3){1.0, 0.0, -4.0};
    struct neph_medium *slab = test_add_medium(test, extinction_per_m, 0.0, 0.0);
    slab->bounds.min_m = (struct neph_vec3){-1e5, -3.0, -1e5};
    slab->bounds.max_m = (struct neph_vec3){1e5, 0.0, 1e5};
    return slab;
}

static struct neph_image *render(struct neph_vulkan *vulkan, const struct test_scene *test,
                                 enum neph_march_lighting lighting, int steps, float *volume[3])
{
    const struct neph_march_params params = {.width_px = width_px,
                                             .height_px = height_px,
                                             .steps = steps,
                                             .sun_steps = 64,
                                             .lighting = lighting};
    struct neph_image *frame = test_march(vulkan, &test->scene, &params, NULL);
    assert_true(neph_image_rgb(frame, "volume", volume));
    return frame;
}

static double phase_per_sr(const struct neph_phase *phase, double part, double cosine)
{
    const double g = phase->g * part;
    if (phase->kind == NEPH_PHASE_HENYEY_GREENSTEIN)
        return (1.0 - g * g) / (4.0 * M_PI * pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
    return 1.0 / (4.0 * M_PI) +
           part * (3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine) - 1.0 / (4.0 * M_PI));
}

/* Integral of the octave sum over the slab: each octave is an exponential along the ray. */
static double slab_octaves(const struct test_scene *test, struct neph_vec3 ray)
{
    const struct neph_medium *slab = &test->scene.media[0];
    const struct neph_octaves *octaves = &test->scene.octaves;
    const struct neph_vec3 sun = test->scene.sun.direction;
    const double depth = slab->layers[0].extinction_per_m * 3.0 / -ray.y;
    double sum = 0.0, a = 1.0, b = 1.0, c = 1.0;
    for (int i = 0; i < octaves->count; i++) {
        const double rate = 1.0 + b * -ray.y / sun.y;
        sum += a * phase_per_sr(&slab->phase, c, neph_vec3_dot(ray, sun)) * -expm1(-rate * depth) /
               rate;
        a *= octaves->contribution;
        b *= octaves->attenuation;
        c *= octaves->eccentricity;
    }
    return slab->albedo.g * test->scene.sun.irradiance_w_per_m2.g * sum;
}

static void test_octaves_over_a_slab(void **state)
{
    static const struct neph_octaves octaves[] = {
        {1, 0.5, 0.5, 0.5}, {8, 0.5, 0.5, 0.5}, {3, 0.8, 0.2, 0.9}, {16, 1.0, 0.0, 0.0}};
    static const struct neph_phase phases[] = {{NEPH_PHASE_HENYEY_GREENSTEIN, 0.85},
                                               {NEPH_PHASE_HENYEY_GREENSTEIN, 0.0},
                                               {NEPH_PHASE_RAYLEIGH, 0.0}};
    for (int round = 0; round < 12; round++) {
        struct test_scene test;
        float *volume[3];
        struct neph_medium *slab = look_down_on_slab(&test, round % 2 ? 0.1 : 1.0);
        slab->phase = phases[round % 3];
        test.scene.octaves = octaves[round / 3];
        OWNED(image)
        struct neph_image *frame = render(*state, &test, NEPH_MARCH_OCTAVES, 512, volume);
        /* Error of sampling at the middle of a step of optical depth h. The sun's exponent has at
         * most k = 1 / sun.y per unit of the view's: (h k)^2 / 24. The view's weight has its centre
         * nearer by h^2 / 12: h^2 k / 12. */
        for (int p = 0; p < width_px * height_px; p++) {
            const struct neph_vec3 ray = test_ray(&test.scene, width_px, height_px, p).direction;
            const double h = slab->layers[0].extinction_per_m * 3.0 / -ray.y / 512.0;
            const double k = 1.0 / test.scene.sun.direction.y;
            neph_assert_close((double)volume[1][p], slab_octaves(&test, ray),
                              h * h * k * (k / 24.0 + 1.0 / 12.0) + 5e-6, 0.0);
        }
    }
}

/* Fitted octaves: the optical depth of the view is scaled, too. */
static double slab_fitted(const struct test_scene *test, struct neph_vec3 ray, int channel)
{
    const struct neph_medium *slab = &test->scene.media[0];
    const struct neph_vec3 sun = test->scene.sun.direction;
    const double albedos[3] = {slab->albedo.r, slab->albedo.g, slab->albedo.b};
    const double mean = (albedos[0] + albedos[1] + albedos[2]) / 3.0;
    const struct neph_octaves all = neph_octaves_compute(&neph_octaves_fitted, slab->phase.g, mean);
    const struct neph_octaves own = neph_octaves_compute(&neph_octaves_fitted, slab->phase.g,
                                                         albedos[channel]);
    const double depth = slab->layers[0].extinction_per_m * 3.0 / -ray.y;
    double sum = 0.0, a = 1.0, b = 1.0, c = 1.0;
    for (int i = 0; i < all.count; i++) {
        sum += a * phase_per_sr(&slab->phase, c, neph_vec3_dot(ray, sun)) * depth *
               neph_phi(b * (1.0 - ray.y / sun.y) * depth);
        a *= own.contribution;
        b *= all.attenuation;
        c *= all.eccentricity;
    }
    return albedos[channel] * test->scene.sun.irradiance_w_per_m2.g * sum;
}

static void test_fitted_octaves_over_a_slab(void **state)
{
    static const struct neph_rgb albedos[] = {{1, 1, 1}, {0.9, 0.9, 0.9}, {1, 0.95, 0.5}};
    static const double gs[] = {0.85, 0.0, 0.5};
    for (int round = 0; round < 3; round++) {
        struct test_scene test;
        float *volume[3];
        struct neph_medium *slab = look_down_on_slab(&test, round % 2 ? 0.3 : 1.0);
        slab->albedo = albedos[round];
        slab->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, gs[round]};
        test.scene.sun.irradiance_w_per_m2 = (struct neph_rgb){3, 3, 3};
        OWNED(image)
        struct neph_image *frame = render(*state, &test, NEPH_MARCH_OCTAVES_FITTED, 128, volume);
        for (int p = 0; p < width_px * height_px; p++) {
            const struct neph_vec3 ray = test_ray(&test.scene, width_px, height_px, p).direction;
            const double h = slab->layers[0].extinction_per_m * 3.0 / -ray.y / 128.0;
            const double k = 1.0 / test.scene.sun.direction.y;
            for (int channel = 0; channel < 3; channel++)
                neph_assert_close((double)volume[channel][p], slab_fitted(&test, ray, channel),
                                  h * h * k * (k / 24.0 + 1.0 / 12.0) + 2e-5, 0.0);
        }
    }
}

/* Reciprocity: view straight down with the sun at an angle, and view at that angle with the sun at
 * the zenith. The reflected radiance over the irradiance of a horizontal plane is the same (S.
 * Chandrasekhar, "Radiative Transfer", 1950, section 13). */
static void test_fitted_octaves_are_reciprocal(void **state)
{
    static const struct neph_vec3 ways[] = {{0.0, 1.0, 0.0}, {0.6, 0.8, 0.0}};
    double reflected[2];
    for (int i = 0; i < 2; i++) {
        struct test_scene test;
        float *volume[3];
        struct neph_medium *slab = look_down_on_slab(&test, 1.0);
        slab->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.7};
        const struct neph_vec3 to_eye = ways[i];
        test.key.position_m = neph_vec3_scale(to_eye, 10.0);
        test.key.look_at_m = (struct neph_vec3){0.0, 0.0, 0.0};
        test.scene.camera_up = (struct neph_vec3){0.0, 0.0, 1.0};
        test.scene.vertical_fov_rad = 1e-3;
        test.scene.sun.direction = ways[1 - i];
        OWNED(image)
        struct neph_image *frame = render(*state, &test, NEPH_MARCH_OCTAVES_FITTED, 512, volume);
        reflected[i] = (double)volume[1][height_px / 2 * width_px + width_px / 2] / ways[1 - i].y;
    }
    /* f_r = L / (E mu0) is the same both ways; step errors as above, the frame is 1e-3 wide. */
    neph_assert_close(reflected[0], reflected[1], 1e-3, 0.0);
}

/* --- similar media ---------------------------------------------------------------------------- */

/* A ray into the slab: optical depths to the middle of a step. */
struct way {
    double seen, sun, step; /* optical depths */
};

enum { WAY_STEPS = 4000 };

static struct way way_at(const struct test_scene *test, struct neph_vec3 ray, int i)
{
    const double sigma = test->scene.media[0].layers[0].extinction_per_m;
    const double step = sigma * 3.0 / -ray.y / WAY_STEPS;
    return (struct way){(i + 0.5) * step, (i + 0.5) * step * -ray.y / test->scene.sun.direction.y,
                        step};
}

static double hg_per_sr(double g, double cosine)
{
    return phase_per_sr(&(struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, g}, 1.0, cosine);
}

/* similarity_light() of shaders/march_light.glsl. */
static double slab_similarity(const struct test_scene *test, struct neph_vec3 ray)
{
    const struct neph_medium *slab = &test->scene.media[0];
    const double g = slab->phase.g, albedo = slab->albedo.g, peak = neph_similar_peak(g);
    const double cosine = neph_vec3_dot(ray, test->scene.sun.direction);
    const struct neph_octaves octaves = neph_octaves_compute(
        &neph_octaves_fitted, neph_similar_g(g), neph_similar_albedo(albedo, g));
    double sum = 0.0;
    for (int i = 0; i < WAY_STEPS; i++) {
        const struct way way = way_at(test, ray, i);
        const double once = exp(-way.seen - way.sun);
        double part = 1.0 - peak, depth = 1.0 - peak * albedo, own_g = neph_similar_g(g);
        double light = once * (hg_per_sr(g, cosine) - part * hg_per_sr(own_g, cosine));
        for (int o = 0; o < octaves.count; o++) {
            light += part * hg_per_sr(own_g, cosine) * exp(-depth * (way.seen + way.sun));
            part *= octaves.contribution;
            depth *= octaves.attenuation;
            own_g *= octaves.eccentricity;
        }
        sum += light * way.step;
    }
    return albedo * test->scene.sun.irradiance_w_per_m2.g * sum;
}

/* slab_light() of shaders/slab_light.glsl, with exact values where the shader interpolates the
 * table. */
static double slab_of_slabs(const struct test_scene *test, struct neph_vec3 ray)
{
    const struct neph_medium *slab = &test->scene.media[0];
    const double g = slab->phase.g, albedo = slab->albedo.g, scale = 1.0 - g * albedo;
    const double whole = slab->layers[0].extinction_per_m * 3.0 / test->scene.sun.direction.y;
    const double similar = albedo >= 1.0 ? 1.0 : albedo * (1.0 - g) / scale;
    const double cosine = neph_vec3_dot(ray, test->scene.sun.direction);
    enum { EACH = 50 }; /* steps per table value, which is expensive */
    double sum = 0.0, more = 0.0;
    for (int i = 0; i < WAY_STEPS; i++) {
        const struct way way = way_at(test, ray, i), middle = way_at(test, ray, i + EACH / 2);
        const double once = exp(-way.seen - way.sun);
        if (i % EACH == 0)
            more = neph_slab_light_per_sr(scale * middle.sun, scale * (whole - middle.sun),
                                          similar);
        sum += way.step *
               (hg_per_sr(g, cosine) * once +
                (1.0 - g) * (more * exp(-scale * way.seen) +
                             (exp(-scale * (way.seen + way.sun)) - once) / (4.0 * M_PI)));
    }
    return albedo * test->scene.sun.irradiance_w_per_m2.g * sum;
}

static const struct {
    enum neph_march_lighting lighting;
    double (*reference)(const struct test_scene *test, struct neph_vec3 ray);
    double allowed;
} similar[] = {
    {NEPH_MARCH_SIMILARITY, slab_similarity, 2e-3},
    {NEPH_MARCH_SLAB, slab_of_slabs, 2e-2}, /* linear interpolation of the table */
};

static void test_similar_media_over_a_slab(void **state)
{
    static const double albedos[] = {1.0, 0.93}, gs[] = {0.85, 0.0};
    for (size_t s = 0; s < sizeof(similar) / sizeof(similar[0]); s++)
        for (int round = 0; round < 2; round++) {
            struct test_scene test;
            float *volume[3];
            struct neph_medium *slab = look_down_on_slab(&test, round ? 0.5 : 2.0);
            slab->albedo = make_grey(albedos[round]);
            slab->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, gs[round]};
            OWNED(image)
            struct neph_image *frame = render(*state, &test, similar[s].lighting, 256, volume);
            double worst = 0.0;
            for (int p = 7; p < width_px * height_px; p += 97) {
                const struct neph_vec3 ray =
                    test_ray(&test.scene, width_px, height_px, p).direction;
                const double reference = similar[s].reference(&test, ray);
                worst = fmax(worst, fabs((double)volume[1][p] / reference - 1.0));
            }
            print_message("lighting %d, g %g: off by %.1e of its formula\n",
                          (int)similar[s].lighting, gs[round], worst);
            assert_true(worst < similar[s].allowed);
        }
}

/* Without sides the table is the slab of adding and doubling: the upward flux of its multiple and
 * single scattering is the flux that the slab reflects. */
static void test_the_table_is_a_slab(void **state)
{
    static const double depths[] = {1.0, 8.0, 40.0}, albedos[] = {1.0, 0.9};
    for (int d = 0; d < 3; d++)
        for (int a = neph_test_by_day(d % 2, 0); a < 2; a += neph_test_by_day(2, 1)) {
            const struct neph_slab_params params = {
                .optical_depth = depths[d], .albedo = albedos[a], .sun_cosine = 1.0};
            OWNED(slab) struct neph_slab *slab = NULL;
            struct neph_diag diag = {0};
            enum { STEPS = 400 };
            double up = 0.0;
            neph_assert_ok(neph_slab_create(&params, &slab, &diag), &diag);
            /* The fraction of light scattered at a depth t that reaches the top is E2(t), of the
             * upward half. */
            for (int i = 0; i < STEPS; i++) {
                const double x = (i + 0.5) / STEPS, t = depths[d] * x * x;
                const double mean = neph_slab_light_infinite_per_sr(t, depths[d] - t, albedos[a]);
                const double source = albedos[a] * (mean + exp(-t) / (4.0 * M_PI));
                up += 2.0 * M_PI * neph_slab_light_e2(t) * source * depths[d] * 2.0 * x / STEPS;
            }
            const double truth = neph_slab_fluxes(slab).reflected;
            print_message("depth %g, albedo %g: %.5f reflected, %.5f by adding and doubling\n",
                          depths[d], albedos[a], up, truth);
            assert_true(fabs(up / truth - 1.0) < 5e-3);
        }
}

static void test_one_octave_is_single_scattering(void **state)
{
    struct test_scene test;
    float *octaves[3], *single[3];
    look_down_on_slab(&test, 0.4);
    test.scene.octaves = (struct neph_octaves){1, 0.3, 0.3, 0.3};
    OWNED(image) struct neph_image *a = render(*state, &test, NEPH_MARCH_OCTAVES, 64, octaves);
    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    OWNED(image) struct neph_image *b = render(*state, &test, NEPH_MARCH_SINGLE, 64, single);
    for (int p = 0; p < width_px * height_px; p++) /* sums in another order */
        neph_assert_close((double)octaves[0][p], (double)single[0][p], 1e-6, 0.0);
}

/* --- horizon ------------------------------------------------------------------------------- */

static const struct neph_horizon_params cloudy = {
    .seed = 3,
    .planet_radius_m = 2e5,
    .bottom_m = 80.0,
    .thickness_m = 280.0,
    .coverage = 0.9,
    .density = 1.5,
    .texture_scale_m = 6000.0,
    .base_repeats = 10.0,
    .detail_repeats = 40.0,
};

/* A box inside the layer, seen from below. */
static struct neph_medium *look_up_at_clouds(struct test_scene *test,
                                             const struct neph_horizon_params *params)
{
    struct neph_diag diag = {0};
    test_scene_init(test);
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->key.position_m = (struct neph_vec3){0.0, 10.0, 0.0};
    test->key.look_at_m = (struct neph_vec3){100.0, 120.0, -300.0};
    struct neph_medium *layer = test_add_medium(test, 0.0, 0.0, 0.0);
    *layer = (struct neph_medium){.kind = NEPH_MEDIUM_HORIZON,
                                  .bounds = {{-600.0, 100.0, -900.0}, {900.0, 340.0, 100.0}},
                                  .extinction_color = {1, 1, 1},
                                  .albedo = {1, 1, 1},
                                  .extinction_per_m = 0.02};
    neph_assert_ok(neph_horizon_create(params, &layer->horizon, &diag), &diag);
    return layer;
}

/* Distance from below the layer to its bottom or top. */
static double way_to_sphere_m(struct neph_vec3 origin_m, struct neph_vec3 ray, double radius_m)
{
    const struct neph_vec3 center_m = {0.0, cloudy.bottom_m - cloudy.planet_radius_m, 0.0};
    const struct neph_vec3 out_m = neph_vec3_sub(origin_m, center_m);
    const double rise_m = neph_vec3_dot(out_m, ray);
    return -rise_m + sqrt(rise_m * rise_m - neph_vec3_dot(out_m, out_m) + radius_m * radius_m);
}

static double remap(double x, double a, double b, double c, double d)
{
    return c + (x - a) * (d - c) / (b - a);
}

/* The article's CalculateLight at a point; 1 is a white surface in full sun. */
static double article_light(const struct test_scene *test, struct neph_vec3 point_m,
                            struct neph_vec3 ray, double chord_m)
{
    const struct neph_horizon *horizon = test->scene.media[0].horizon;
    const struct neph_vec3 sun = test->scene.sun.direction;
    const double cosine = neph_vec3_dot(ray, sun);
    const struct neph_phase ahead = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5};
    const struct neph_phase back = {NEPH_PHASE_HENYEY_GREENSTEIN, -0.1};
    double whole;
    const double density = neph_horizon_density(horizon, point_m, &whole);
    const double height = horizon_height(horizon, point_m);
    const double to_sun = density +
                          neph_horizon_density(
                              horizon, neph_vec3_along(point_m, sun, 0.025 * chord_m), NULL);
    const double beer = fmax(exp(-2.0 * to_sun), 0.7 * exp(-2.0 * 0.25));
    const double lobe = cosine > 0.0 ? cosine * cosine : 0.0;
    const double phase = 0.5 * fmax(phase_per_sr(&ahead, 1.0, cosine), lobe) +
                         0.5 * phase_per_sr(&back, 1.0, cosine);
    const double depth = pow(whole, remap(height, 0.3, 0.85, 0.5, 1.3)) + 0.05;
    const double upright = pow(fmax(0.0, remap(height, 0.07, 0.14, 0.1, 1.0)), 0.8);
    return fmax(0.4 * density, beer * phase * depth * upright);
}

static double article_sum(const struct test_scene *test, struct neph_vec3 ray, int steps)
{
    const struct neph_medium *layer = &test->scene.media[0];
    const struct neph_vec3 eye_m = test->key.position_m;
    double t0_m = 0.0, t1_m = INFINITY;
    const double e[3] = {eye_m.x, eye_m.y, eye_m.z}, d[3] = {ray.x, ray.y, ray.z};
    const double low[3] = {layer->bounds.min_m.x, layer->bounds.min_m.y, layer->bounds.min_m.z};
    const double high[3] = {layer->bounds.max_m.x, layer->bounds.max_m.y, layer->bounds.max_m.z};
    for (int k = 0; k < 3; k++) {
        const double a = (low[k] - e[k]) / d[k], b = (high[k] - e[k]) / d[k];
        t0_m = fmax(t0_m, fmin(a, b));
        t1_m = fmin(t1_m, fmax(a, b));
    }
    if (t1_m <= t0_m)
        return 0.0;
    const double radius_m = cloudy.planet_radius_m;
    const double chord_m = way_to_sphere_m(eye_m, ray, radius_m + cloudy.thickness_m) -
                           way_to_sphere_m(eye_m, ray, radius_m);
    const double step_m = (t1_m - t0_m) / steps;
    double sum = 0.0, transmittance = 1.0;
    for (int i = 0; i < steps; i++) {
        const struct neph_vec3 point_m = neph_vec3_along(eye_m, ray, t0_m + (i + 0.5) * step_m);
        const double depth = layer->extinction_per_m * step_m *
                             neph_horizon_density(layer->horizon, point_m, NULL);
        const double mean = depth > 0.0 ? -expm1(-depth) / depth : 1.0;
        sum += article_light(test, point_m, ray, chord_m) * layer->extinction_per_m * step_m *
               transmittance * mean;
        transmittance *= exp(-depth);
    }
    return test->scene.sun.irradiance_w_per_m2.g / M_PI * sum * (1.0 - transmittance);
}

static void test_horizon_light_is_the_articles(void **state)
{
    OWNED(media) struct test_scene test;
    float *volume[3];
    const int steps = 64;
    look_up_at_clouds(&test, &cloudy);
    OWNED(image)
    struct neph_image *frame = render(*state, &test, NEPH_MARCH_HORIZON, steps, volume);
    double brightest = 0.0, darkest = INFINITY;
    for (int p = 0; p < width_px * height_px; p++) {
        const struct neph_vec3 ray = test_ray(&test.scene, width_px, height_px, p).direction;
        const double expected = article_sum(&test, ray, steps);
        /* Both take the same steps. Clamped noise amplifies float32 positions, which are accurate
         * to 1e-4 of a texel at a kilometre. */
        neph_assert_close((double)volume[1][p], expected, 2e-3, 2e-4);
        brightest = fmax(brightest, expected);
        darkest = fmin(darkest, expected);
    }
    print_message("radiance %g to %g W/m2/sr\n", darkest, brightest);
    assert_true(brightest > 10.0 * darkest && brightest > 0.3);
}

/* Light in an empty layer is hidden by the article's own blending: the frame shows the sky. */
static void test_horizon_light_of_an_empty_layer(void **state)
{
    OWNED(media) struct test_scene test;
    float *volume[3], *radiance[3];
    struct neph_horizon_params clear = cloudy;
    clear.coverage = 0.0;
    look_up_at_clouds(&test, &clear);
    OWNED(image) struct neph_image *frame = render(*state, &test, NEPH_MARCH_HORIZON, 16, volume);
    assert_true(neph_image_rgb(frame, NULL, radiance));
    for (int p = 0; p < width_px * height_px; p++)
        assert_true(volume[2][p] == 0.0f && radiance[2][p] == 0.4f);
}

static void test_models_refuse_unsupported_scenes(void **state)
{
    struct test_scene test;
    char reason[256];
    look_down_on_slab(&test, 1.0);
    struct neph_scene *scene = &test.scene;
    assert_false(neph_march_can_render(scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    assert_true(neph_march_can_render(scene, NEPH_MARCH_OCTAVES, reason, sizeof(reason)));
    assert_false(neph_march_can_render(scene, NEPH_MARCH_HORIZON, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "Horizon"));
    scene->scattering = NEPH_SCATTERING_SINGLE;
    assert_true(neph_march_can_render(scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    assert_false(neph_march_can_render(scene, NEPH_MARCH_OCTAVES, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "all orders"));
    scene->scattering = NEPH_SCATTERING_MULTIPLE;
    scene->environment_light = true;
    assert_false(neph_march_can_render(scene, NEPH_MARCH_OCTAVES, reason, sizeof(reason)));
}

#include "tests/renderer/main.h"

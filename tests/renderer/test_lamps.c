/* SPDX-License-Identifier: MIT
 *
 * Point and spot lights on the device: the ray marcher converges to the exact transport, the tracer
 * agrees with it within its noise, and for all orders the tracer agrees with the oracle.
 */
#include "tests/lamp_stage.h"
#include "tests/renderer/frames.h"

enum { WIDTH_PX = 24, HEIGHT_PX = 16, PIXELS = WIDTH_PX * HEIGHT_PX };

/* ---- march ---- */

struct error {
    double bias, rms; /* relative to the sum, and to the mean */
};

static struct error march_error(struct neph_vulkan *vulkan, const struct test_scene *test,
                                const struct neph_march_params *params)
{
    OWNED(memory) struct neph_ray_light *exact = test_exact(&test->scene, WIDTH_PX, HEIGHT_PX);
    OWNED(image) struct neph_image *frame = test_march(vulkan, &test->scene, params, NULL);
    const float *radiance = neph_image_channel(frame, "G");
    double sum = 0.0, off = 0.0, squares = 0.0;
    for (int p = 0; p < PIXELS; p++) {
        const double error = (double)radiance[p] - exact[p].radiance.g;
        sum += exact[p].radiance.g;
        off += error;
        squares += error * error;
    }
    return (struct error){off / sum, sqrt(squares / PIXELS) / (sum / PIXELS)};
}

static struct neph_march_params march_params(int steps, enum neph_march_mode sun)
{
    return (struct neph_march_params){.width_px = WIDTH_PX,
                                      .height_px = HEIGHT_PX,
                                      .steps = steps,
                                      .transmittance = NEPH_MARCH_EXACT,
                                      .sun = sun,
                                      .sun_steps = 64,
                                      .lighting = NEPH_MARCH_SINGLE};
}

/* Shadow edges make the rule first order: four times as many steps leave a quarter of the error.
 * Without the exact mean of 1/d^2 the error of 32 steps is 40 %. 128 steps are below the limit, and
 * 512, which need a kernel of their own, below a tenth of it. */
static void test_the_march_comes_to_the_exact_transport(void **state)
{
    struct test_scene test;
    lamp_stage(&test);
    struct error last = {1.0, 1.0};
    for (int steps = 32; steps <= neph_test_by_day(128, 512); steps *= 4) {
        const struct neph_march_params params = march_params(steps, NEPH_MARCH_EXACT);
        const struct error error = march_error(*state, &test, &params);
        print_message("%4d steps: sum off by %+.1e, rms %.1e\n", steps, error.bias, error.rms);
        assert_true(error.rms < 0.5 * last.rms);
        last = error;
    }
    assert_true(fabs(last.bias) < 5e-4 && last.rms < 5e-3);
}

/* A steep and a slow unbounded fog, in which 64 steps of a level ray are 16 m long; and a spot
 * light at 9 m with 64 parts and a forward phase function. Twice as many steps leave a quarter of
 * the error (3 to 6, because coarser steps are not yet in the asymptotic range), and the default
 * steps 2 %. Without dividing steps around the light the errors were 20 to 60 %. */
static void test_fog_without_bounds_is_of_second_order(void **state)
{
    static const struct neph_vec3 at_m[] = {{0, 2, 0}, {0, 9, 0}};
    for (int i = 0; i < 4; i += neph_test_by_day(3, 1)) { /* by day one of each */
        struct test_scene test;
        test_scene_init(&test);
        test.key.position_m = (struct neph_vec3){0, 2, 9};
        test.key.look_at_m = at_m[i / 2];
        test.scene.sun.present = false;
        test.scene.background_w_per_m2_sr = make_grey(0.0);
        test.scene.light_count = 1;
        test.scene.lights[0] = (struct neph_light){
            .position_m = {-1.13, 2.37, 0.21},
            .intensity_w_per_sr = {40, 40, 40},
            .is_spot = i % 2,
            .axis = neph_vec3_normalize((struct neph_vec3){0.3, 0.2, 1}),
            .inner_cosine = 0.94,
            .outer_cosine = 0.77};
        struct neph_medium *fog = test_add_medium(&test, 0.05, 0.3, 0.0);
        fog->phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.5};
        fog->layers[fog->layer_count++] = (struct neph_fog_layer){0.01, 0.02, 0.0};
        struct error errors[3];
        for (int k = 0; k < 3; k++) {
            const struct neph_march_params params = march_params(64 << k, NEPH_MARCH_EXACT);
            errors[k] = march_error(*state, &test, &params);
            print_message("%4d steps: sum off by %+.1e, rms %.1e\n", params.steps, errors[k].bias,
                          errors[k].rms);
        }
        assert_true(fabs(errors[0].bias) < 0.02 && errors[0].rms < 0.05);
        assert_true(errors[1].rms < errors[0].rms / 3.0 && errors[2].rms < errors[1].rms / 3.0);
    }
}

/* A metre of fog with the foot of the light's perpendicular a kilometre away, where float32
 * positions have a resolution of 0.06 mm. Steps of 2 mm, 0.3 mm and 0.03 mm keep their length.
 * Lengths from the positions of the ends gave errors of 0.7 %, of 8 %, and no light. Vulkan allows
 * atan() an error of 4,096 units in the last place. */
static void test_short_steps_far_from_a_light(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    test.key.position_m = (struct neph_vec3){0, 0, 0};
    test.key.look_at_m = (struct neph_vec3){0, 0, -1};
    test.scene.vertical_fov_rad = 0.01;
    test.scene.sun.present = false;
    test.scene.background_w_per_m2_sr = make_grey(0.0);
    test.scene.light_count = 1;
    test.scene.lights[0] = (struct neph_light){.position_m = {300, 0, -1000},
                                               .intensity_w_per_sr = {1e6, 1e6, 1e6}};
    test_add_medium(&test, 0.5, 0.0, 0.0)->bounds = (struct neph_bounds){{-1, -1, -1.7},
                                                                         {1, 1, -0.7}};
    static const int steps[] = {3000, 500, 33000}; /* each needs a kernel of its own */
    for (long i = 0; i < neph_test_by_day(1, 3); i++) {
        const struct neph_march_params params = march_params(steps[i], NEPH_MARCH_EXACT);
        const struct error error = march_error(*state, &test, &params);
        print_message("%5d steps: sum off by %+.1e, rms %.1e\n", steps[i], error.bias, error.rms);
        assert_true(fabs(error.bias) < 2.5e-4 && error.rms < 2.5e-4);
    }
}

static void test_marched_depths_to_lamps(void **state)
{
    neph_test_waits_for_the_night();
    struct test_scene test;
    lamp_stage(&test);
    const struct neph_march_params params = march_params(128, NEPH_MARCH_MARCHED);
    const struct error error = march_error(*state, &test, &params);
    assert_true(fabs(error.bias) < 5e-3 && error.rms < 3e-2);
}

static void test_sun_and_lamps_add(void **state)
{
    neph_test_waits_for_the_night();
    struct test_scene test;
    lamp_stage(&test);
    test.scene.sun.present = true;
    test.scene.background_w_per_m2_sr = make_grey(0.1);
    const struct neph_march_params params = march_params(512, NEPH_MARCH_EXACT);
    const struct error error = march_error(*state, &test, &params);
    assert_true(fabs(error.bias) < 1e-3 && error.rms < 5e-3);
}

/* Lighting models that would omit lights refuse the scene. */
static void test_models_without_lights_refuse_them(void **state)
{
    struct test_scene test;
    lamp_stage(&test)->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    for (int l = NEPH_MARCH_SINGLE + 1; l <= NEPH_MARCH_SLAB; l++) {
        char reason[256] = "";
        assert_false(neph_march_can_render(&test.scene, (enum neph_march_lighting)l, reason,
                                           sizeof(reason)));
        assert_true(l == NEPH_MARCH_HORIZON || l == NEPH_MARCH_TRACED || strstr(reason, "lights"));
    }
}

/* ---- tracer ---- */

static struct neph_image *trace(struct neph_vulkan *vulkan, const struct test_scene *test,
                                int samples)
{
    const struct neph_tracer_params params = test_samples(WIDTH_PX, HEIGHT_PX, 7, samples);
    return test_trace(vulkan, &test->scene, &params, NULL);
}

struct sum {
    double light, variance;
};

static struct sum sum_samples(const struct neph_image *frame, int channel)
{
    const struct test_rgb radiance = test_layer(frame, NULL),
                          variance = test_layer(frame, "variance");
    struct sum sum = {0.0, 0.0};
    for (size_t p = 0; p < neph_image_pixel_count(frame); p++) {
        sum.light += (double)radiance.of[channel][p];
        sum.variance += (double)variance.of[channel][p];
    }
    return sum;
}

/* The sum within four standard errors, and the standard error within limits: unbounded noise would
 * exceed them. */
static void test_the_tracer_is_the_exact_transport(void **state)
{
    for (int with_sun = neph_test_by_day(1, 0); with_sun < 2; with_sun++) {
        struct test_scene test;
        lamp_stage(&test)->scene.sun.present = with_sun;
        double exact = 0.0;
        for (int p = 0; p < PIXELS; p++)
            exact += test_exact_ray(&test.scene, WIDTH_PX, HEIGHT_PX, p).radiance.g;
        OWNED(image) struct neph_image *frame = trace(*state, &test, 128);
        const struct sum sum = sum_samples(frame, 1);
        print_message("sum off by %+.1e, standard error %.1e\n", sum.light / exact - 1.0,
                      sqrt(sum.variance) / exact);
        neph_assert_close(sum.light, exact, 0.0, 4.0 * sqrt(sum.variance));
        assert_true(sqrt(sum.variance) < 0.01 * exact);
    }
}

/* All orders, with sun and sky light. */
static void test_of_all_orders_it_is_the_oracle(void **state)
{
    neph_test_waits_for_the_night();
    struct test_scene test;
    lamp_stage(&test)->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test.scene.sun.present = true;
    test.scene.environment_light = true;
    test.scene.background_w_per_m2_sr = make_grey(0.1);
    OWNED(image) struct neph_image *frame = trace(*state, &test, 512);
    OWNED(image) struct neph_image *truth = test_oracle(&test.scene, WIDTH_PX, HEIGHT_PX, 7, 512);
    for (int channel = 0; channel < 3; channel++) {
        const struct sum a = sum_samples(frame, channel), b = sum_samples(truth, channel);
        print_message("sum off by %+.1e, standard error %.1e\n", a.light / b.light - 1.0,
                      sqrt(a.variance + b.variance) / b.light);
        neph_assert_close(a.light, b.light, 0.0, 4.0 * sqrt(a.variance + b.variance));
    }
}

/* Each pixel of each stage, and the variance of the scores. A z-score beyond 5 occurs once in 1,000
 * runs of some 1,100 pixels. In pixels that graze the box the variance is below the rounding error
 * of the path through it in float32, 1e-6 of the radiance, which is used instead. */
static void test_the_tracer_finds_lights_near_rays(void **state)
{
    double squares = 0.0;
    int pixels = 0;
    for (int l = 0; l < NEAR_LAMPS; l++) {
        struct test_scene test;
        const struct neph_scene *scene = near_lamp_stage(&test, &near_lamps[l]);
        const struct neph_tracer_params params = test_samples(15, 9, (uint64_t)l,
                                                              neph_test_by_day(1024, 4096));
        OWNED(image) struct neph_image *frame = test_trace(*state, scene, &params, NULL);
        const float *radiance = neph_image_channel(frame, "G"),
                    *variance = neph_image_channel(frame, "variance.G");
        double worst = 0.0;
        for (int p = 0; p < 15 * 9; p++) {
            const double truth = test_exact_ray(scene, 15, 9, p).volume.g;
            const double rounding = 1e-6 * truth;
            if (truth == 0.0)
                continue;
            const double z = ((double)radiance[p] - truth) /
                             sqrt((double)variance[p] + rounding * rounding);
            worst = fmax(worst, fabs(z));
            squares += z * z;
            pixels++;
        }
        print_message("%s: worst z-score %.1f\n", near_lamps[l].name, worst);
        assert_true(worst < 5.0);
    }
    print_message("variance of %d z-scores: %.3f\n", pixels, squares / pixels);
    /* 4.5 standard errors, sqrt(2 / n). */
    assert_true(fabs(squares / pixels - 1.0) < 4.5 * sqrt(2.0 / pixels));
}

#include "tests/renderer/main.h"

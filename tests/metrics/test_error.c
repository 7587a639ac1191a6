/* SPDX-License-Identifier: MIT
 *
 * Errors of tiny images computed by hand. All inputs are exact in float; the decimal numbers were
 * computed in rational arithmetic from the definitions in metrics/extractors/error.c.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/extractors/extractors.h"
#include "metrics/statistics.h"

static const double tight = 1e-12;

/* d = .5 -.25 0 | -.25 .25 1; the reference has a mean of 7.75 / 6, a scene mean of 1.10845. */
static const float two_pixels_reference[] = {1, 2, 4, 0.5f, 0.25f, 0};
static const float two_pixels_test[] = {1.5f, 1.75f, 4, 0.25f, 0.5f, 1};

static struct neph_image *rgb_image(int width_px, int height_px, const char *layer,
                                    const float *interleaved)
{
    struct neph_image *image = create_image(width_px, height_px);
    add_rgb(image, layer, interleaved);
    return image;
}

static void assert_two_pixels(const struct measured *m)
{
    neph_assert_close(value_of(m, "bias"), 1.25 / 6, tight, 0);
    neph_assert_close(value_of(m, "rel_bias"), 1.25 / 7.75, tight, 0);
    neph_assert_close(value_of(m, "mae"), 0.375, tight, 0);
    neph_assert_close(value_of(m, "rmse"), 0.48947250518628044112, tight, 0);
    neph_assert_close(value_of(m, "rel_rmse"), 0.37894645562808808345, tight, 0);
    neph_assert_close(value_of(m, "rel_mse"), 1356.7420568080387971, tight, 0);
    neph_assert_close(value_of(m, "max_abs"), 1.0, 0, 0);
    neph_assert_close(value_of(m, "max_rel"), 9021.6067481618476251, tight, 0);
    neph_assert_close(value_of(m, "p50"), 0.25, tight, 0);  /* of 0 .25 .25 .25 .5 1 */
    neph_assert_close(value_of(m, "p95"), 0.875, tight, 0); /* at 4.75 */
    neph_assert_close(value_of(m, "p99"), 0.975, tight, 0); /* at 4.95 */
}

static void test_the_plain_function_is_the_metric(void **state)
{
    const float *const reference[] = {two_pixels_reference}, *const test[] = {two_pixels_test};
    const struct neph_relative_error error = neph_relative_error_of(reference, test, 1, 6);
    neph_assert_close(error.bias, 1.25 / 7.75, tight, 0);
    neph_assert_close(error.rmse, 0.37894645562808808345, tight, 0);
    const float *const black[] = {(const float[6]){0.0f}};
    assert_true(isnan(neph_relative_error_of(black, test, 1, 6).rmse));
}

static void test_two_pixels_by_hand(void **state)
{
    static const struct {
        const char *quantity, *layer, *unit;
    } cases[] = {
        {"radiance", NULL, "W m^-2 sr^-1"},
        {"volume", "volume", "W m^-2 sr^-1"},
        {"transmittance", "transmittance", "1"},
    };
    for (int i = 0; i < 3; i++) {
        struct neph_image *reference = rgb_image(2, 1, cases[i].layer, two_pixels_reference);
        struct neph_image *test = rgb_image(2, 1, cases[i].layer, two_pixels_test);
        struct neph_mask *all = create_mask(reference, "all");
        struct measured m = measure(reference, test, cases[i].quantity, all);
        assert_int_equal(m.count, 12);
        assert_two_pixels(&m);
        for (int k = 0; k < m.count; k++) {
            assert_string_equal(m.all[k].quantity->name, cases[i].quantity);
            assert_string_equal(m.all[k].mask, "all");
            assert_int_equal(m.all[k].pixel_count, 2);
            assert_int_equal(m.all[k].bad_count, 0);
            assert_int_equal(m.all[k].interval, NEPH_INTERVAL_NONE); /* two tiles are too few */
            assert_null(m.all[k].undefined_because);
        }
        assert_string_equal(find(&m, "rmse")->unit, cases[i].unit);
        assert_string_equal(find(&m, "rel_rmse")->unit, "1");
        neph_mask_destroy(all);
        neph_image_destroy(reference);
        neph_image_destroy(test);
    }
}

/* The mask selects samples; the scene mean of rel_mse and max_rel is still the whole frame's. */
static void test_mask_and_scene_mean(void **state)
{
    struct neph_image *reference = rgb_image(2, 1, NULL, two_pixels_reference);
    struct neph_image *test = rgb_image(2, 1, NULL, two_pixels_test);
    add_channel(reference, "Z", (float[]){INFINITY, 7});
    struct neph_mask *solid = create_mask(reference, "solid");
    struct measured m = measure(reference, test, "radiance", solid);
    double epsilon = 0.0110845 * 0.0110845;
    double squares = 0.0625 / (0.25 + epsilon) + 0.0625 / (0.0625 + epsilon) +
                     1.0 / (0.0 + epsilon);
    neph_assert_close(value_of(&m, "bias"), 1.0 / 3, tight, 0);
    neph_assert_close(value_of(&m, "rel_bias"), 1.0 / 0.75, tight, 0);
    neph_assert_close(value_of(&m, "rel_mse"), squares / 3, tight, 0);
    neph_assert_close(value_of(&m, "max_rel"), 1.0 / 1.10845e-4, tight, 0);
    assert_int_equal(find(&m, "bias")->pixel_count, 1);
    assert_string_equal(find(&m, "bias")->mask, "solid");
    neph_mask_destroy(solid);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

static void test_sign_is_test_minus_reference(void **state)
{
    struct neph_image *dark = rgb_image(1, 1, NULL, (float[]){1, 1, 1});
    struct neph_image *bright = rgb_image(1, 1, NULL, (float[]){3, 3, 3});
    struct neph_mask *all = create_mask(dark, "all");
    struct measured m = measure(dark, bright, "radiance", all);
    neph_assert_close(value_of(&m, "bias"), 2.0, 0, 0);
    neph_assert_close(value_of(&m, "rel_bias"), 2.0, tight, 0);
    m = measure(bright, dark, "radiance", all);
    neph_assert_close(value_of(&m, "bias"), -2.0, 0, 0);
    neph_assert_close(value_of(&m, "rel_bias"), -2.0 / 3, tight, 0);
    neph_mask_destroy(all);
    neph_image_destroy(dark);
    neph_image_destroy(bright);
}

static void test_identical_images_are_exactly_zero(void **state)
{
    uint64_t random = test_seed(31);
    enum { WIDTH = 67, HEIGHT = 41 };
    struct neph_image *image = create_image(WIDTH, HEIGHT);
    float *planes[3];
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            planes[c][i] = (float)exp(neph_test_uniform(&random, -20, 20));
    struct neph_mask *all = create_mask(image, "all");
    struct measured m = measure(image, image, "radiance", all);
    for (int i = 0; i < m.count; i++) {
        assert_true(m.all[i].defined);
        assert_true(m.all[i].value == 0.0);
        assert_true(m.all[i].low == 0.0 && m.all[i].high == 0.0);
    }
    assert_int_equal(find(&m, "bias")->interval, NEPH_INTERVAL_TILES);
    assert_int_equal(find(&m, "rel_mse")->interval, NEPH_INTERVAL_TILES);
    assert_int_equal(find(&m, "p95")->interval, NEPH_INTERVAL_TILES);
    assert_int_equal(find(&m, "max_abs")->interval, NEPH_INTERVAL_NONE);
    neph_mask_destroy(all);
    neph_image_destroy(image);
}

/* Equal fireflies (after a clamp) are trimmed like others: of 4800 samples the largest 5, though 12
 * have the same error. */
static void test_equal_fireflies_are_trimmed(void **state)
{
    enum { SIDE = 40 };
    static float reference_rgb[3 * SIDE * SIDE], test_rgb[3 * SIDE * SIDE];
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        reference_rgb[i] = test_rgb[i] = 1;
    for (int firefly = 0; firefly < 4; firefly++)
        for (int c = 0; c < 3; c++)
            test_rgb[3 * (7 + firefly * SIDE * 10 + firefly) + c] = 11;
    struct neph_image *reference = rgb_image(SIDE, SIDE, NULL, reference_rgb);
    struct neph_image *test = rgb_image(SIDE, SIDE, NULL, test_rgb);
    struct neph_mask *all = create_mask(reference, "all");
    struct measured m = measure(reference, test, "radiance", all);
    const double each = 100 / 1.0001, key_of_24_bits = 1e-7;
    neph_assert_close(value_of(&m, "rel_mse"), 12 * each / 4800, 1e-9, 0);
    neph_assert_close(value_of(&m, "rel_mse_trimmed"), 7 * each / 4795, key_of_24_bits, 0);
    const struct neph_measurement *trimmed = find(&m, "rel_mse_trimmed");
    assert_int_equal(trimmed->interval, NEPH_INTERVAL_TILES);
    assert_true(trimmed->low < trimmed->value && trimmed->value < trimmed->high);
    neph_mask_destroy(all);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* Only where both have a solid; solids that one of them misses are a separate measure. */
static void test_depth_by_hand(void **state)
{
    struct neph_image *reference = create_image(5, 1), *test = create_image(5, 1);
    add_channel(reference, "Z", (float[]){2, 4, INFINITY, 8, INFINITY});
    add_channel(test, "Z", (float[]){2.5f, 3, INFINITY, INFINITY, 1});
    struct neph_mask *all = create_mask(reference, "all");
    struct measured m = measure(reference, test, "depth", all);
    assert_int_equal(m.count, 13);
    neph_assert_close(value_of(&m, "bias"), -0.25, tight, 0);
    neph_assert_close(value_of(&m, "rel_bias"), -0.5 / 6, tight, 0);
    neph_assert_close(value_of(&m, "mae"), 0.75, tight, 0);
    neph_assert_close(value_of(&m, "rmse"), sqrt(0.625), tight, 0);
    neph_assert_close(value_of(&m, "rel_mse"), 0.062478742475831704520, tight, 0);
    neph_assert_close(value_of(&m, "max_rel"), 0.25, tight, 0);
    neph_assert_close(value_of(&m, "p50"), 0.75, tight, 0);
    neph_assert_close(value_of(&m, "hit_mismatch"), 2.0 / 5, tight, 0);
    assert_int_equal(find(&m, "bias")->pixel_count, 2);
    assert_int_equal(find(&m, "hit_mismatch")->pixel_count, 5);
    assert_string_equal(find(&m, "bias")->unit, "m");
    neph_mask_destroy(all);

    struct neph_mask *sky = create_mask(reference, "sky");
    m = measure(reference, test, "depth", sky);
    assert_false(find(&m, "bias")->defined);
    assert_string_equal(find(&m, "bias")->undefined_because,
                        "no pixel of the mask is solid in both images");
    assert_int_equal(find(&m, "bias")->pixel_count, 0);
    neph_assert_close(value_of(&m, "hit_mismatch"), 0.5, tight, 0);
    neph_mask_destroy(sky);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

static void assert_all_undefined(const struct measured *m, const char *because, size_t bad_count)
{
    for (int i = 0; i < m->count; i++) {
        const struct neph_measurement *one = &m->all[i];
        assert_false(one->defined);
        assert_string_equal(one->undefined_because, because);
        assert_int_equal(one->bad_count, bad_count);
        assert_int_equal(one->interval, NEPH_INTERVAL_NONE);
        assert_true(one->value == 0.0 && one->low == 0.0 && one->high == 0.0);
    }
}

static const char bad_pixel[] = "a pixel of the mask is not finite in one of the images";

/* A bad pixel is never skipped, in either image and any channel; outside the mask it affects only
 * the scene mean. */
static void test_bad_pixels_make_undefined(void **state)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    enum { PIXELS = 20 * 20 };
    for (int round = 0; round < 18; round++) {
        struct neph_image *images[2] = {create_image(20, 20), create_image(20, 20)};
        float *planes[2][3];
        for (int k = 0; k < 2; k++) {
            neph_assert_ok(neph_image_add_rgb(images[k], NULL, planes[k], NULL), NULL);
            for (int c = 0; c < 3; c++)
                for (int i = 0; i < PIXELS; i++)
                    planes[k][c][i] = 1.0f + (float)k;
        }
        planes[round % 2][round % 3][17 * 20 + 3] = bad[round / 6];
        planes[0][2][5] = NAN; /* two faults in one pixel are one bad pixel */
        planes[1][1][5] = INFINITY;
        struct neph_mask *mask = create_mask(images[0], "all");
        struct measured m = measure(images[0], images[1], "radiance", mask);
        assert_all_undefined(&m, bad_pixel, 2);
        assert_int_equal(find(&m, "bias")->pixel_count, PIXELS - 2);

        mask->inside[17 * 20 + 3] = mask->inside[5] = 0;
        mask->pixel_count -= 2;
        m = measure(images[0], images[1], "radiance", mask);
        assert_true(value_of(&m, "bias") == 1.0);
        assert_int_equal(find(&m, "bias")->interval, NEPH_INTERVAL_TILES);
        assert_false(find(&m, "rel_mse")->defined);
        assert_int_equal(find(&m, "rel_mse")->interval, NEPH_INTERVAL_NONE);
        assert_string_equal(find(&m, "max_rel")->undefined_because,
                            "the mean of the whole reference frame is not positive and finite");
        neph_mask_destroy(mask);
        neph_image_destroy(images[0]);
        neph_image_destroy(images[1]);
    }
}

static void test_bad_depth_makes_undefined(void **state)
{
    struct neph_image *reference = create_image(3, 1), *test = create_image(3, 1);
    add_channel(reference, "Z", (float[]){1, INFINITY, 3});
    float *depth_m = add_channel(test, "Z", (float[]){1, NAN, 3});
    struct neph_mask *all = create_mask(reference, "all");
    struct measured m = measure(reference, test, "depth", all);
    assert_all_undefined(&m, bad_pixel, 1);
    depth_m[1] = -INFINITY;
    m = measure(reference, test, "depth", all);
    assert_all_undefined(&m, bad_pixel, 1);
    neph_mask_destroy(all);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

static void test_empty_mask_and_reference_without_a_mean(void **state)
{
    struct neph_image *black = rgb_image(1, 1, NULL, (float[]){0, 0, 0});
    struct neph_image *grey = rgb_image(1, 1, NULL, (float[]){0.5f, 0.5f, 0.5f});
    add_channel(black, "Z", (float[]){1});
    struct neph_mask *sky = create_mask(black, "sky");
    struct measured m = measure(black, grey, "radiance", sky);
    assert_all_undefined(&m, "the mask is empty", 0);
    neph_mask_destroy(sky);

    struct neph_mask *all = create_mask(black, "all");
    m = measure(black, grey, "radiance", all);
    neph_assert_close(value_of(&m, "bias"), 0.5, 0, 0);
    neph_assert_close(value_of(&m, "p99"), 0.5, 0, 0);
    static const char *const relative[] = {"rel_bias", "rel_rmse", "rel_mse", "max_rel"};
    for (int i = 0; i < 4; i++) {
        assert_false(find(&m, relative[i])->defined);
        assert_non_null(find(&m, relative[i])->undefined_because);
        assert_true(find(&m, relative[i])->value == 0.0);
    }
    neph_mask_destroy(all);
    neph_image_destroy(black);

    struct neph_image *negative = rgb_image(1, 1, NULL, (float[]){-1, -1, -1});
    all = create_mask(negative, "all");
    m = measure(negative, grey, "radiance", all);
    neph_assert_close(value_of(&m, "bias"), 1.5, 0, 0);
    for (int i = 0; i < 4; i++)
        assert_false(find(&m, relative[i])->defined);
    neph_mask_destroy(all);
    neph_image_destroy(negative);
    neph_image_destroy(grey);
}

/* Twice the light gives twice the absolute and the same relative errors: there is no absolute
 * epsilon. */
static void test_relative_metrics_do_not_know_the_unit(void **state)
{
    for (int power = -60; power <= 60; power += 20) {
        float reference_values[6], test_values[6];
        for (int i = 0; i < 6; i++) {
            reference_values[i] = ldexpf(two_pixels_reference[i], power);
            test_values[i] = ldexpf(two_pixels_test[i], power);
        }
        struct neph_image *reference = rgb_image(2, 1, NULL, reference_values);
        struct neph_image *test = rgb_image(2, 1, NULL, test_values);
        struct neph_mask *all = create_mask(reference, "all");
        struct measured m = measure(reference, test, "radiance", all);
        neph_assert_close(value_of(&m, "rel_mse"), 1356.7420568080387971, tight, 0);
        neph_assert_close(value_of(&m, "rel_rmse"), 0.37894645562808808345, tight, 0);
        neph_assert_close(value_of(&m, "max_rel"), 9021.6067481618476251, tight, 0);
        neph_assert_close(value_of(&m, "rmse"), ldexp(0.48947250518628044112, power), tight, 0);
        neph_mask_destroy(all);
        neph_image_destroy(reference);
        neph_image_destroy(test);
    }
}

/* Ten million pixels (fewer under the sanitizers) at 1e6 with differences of one float ulp that
 * cancel except in one pixel. A float sum loses them: it stops growing once the addend is below
 * half its ulp. */
static void test_sums_are_in_double(void **state)
{
    enum { SIDE = NEPH_TEST_EVERY > 1 ? 1200 : 3200 };
    const size_t pixel_count = (size_t)SIDE * SIDE;
    const double ulp = 0.0625;
    struct neph_image *reference = create_image(SIDE, SIDE), *test = create_image(SIDE, SIDE);
    float *from = add_channel(reference, "Z", NULL), *to = add_channel(test, "Z", NULL);
    float float_sum = 0.0f;
    for (size_t i = 0; i < pixel_count; i++) {
        from[i] = 1e6f;
        to[i] = 1e6f + (i % 2 == 0 || i == 12345 ? 0.0625f : -0.0625f);
        float_sum += from[i];
    }
    struct neph_mask *all = create_mask(reference, "all");
    struct measured m = measure(reference, test, "depth", all);
    neph_assert_close(value_of(&m, "bias"), 2 * ulp / (double)pixel_count, tight, 0);
    neph_assert_close(value_of(&m, "rel_bias"), 2 * ulp / (double)pixel_count / 1e6, tight, 0);
    neph_assert_close(value_of(&m, "mae"), ulp, tight, 0);
    neph_assert_close(value_of(&m, "rmse"), ulp, tight, 0);
    neph_assert_close(value_of(&m, "p50"), ulp, 0, 0);
    neph_assert_close(value_of(&m, "rel_rmse"), ulp / 1e6, tight, 0);
    double float_error = (double)float_sum / (1e6 * (double)pixel_count) - 1.0;
    print_message("the mean in a float sum would be off by %.2g\n", float_error);
    assert_true(fabs(float_error) > 1e-3);
    neph_mask_destroy(all);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

static void test_refusals(void **state)
{
    struct neph_image *small = rgb_image(1, 1, NULL, (float[]){1, 1, 1});
    struct neph_image *large = rgb_image(2, 1, NULL, two_pixels_test);
    const struct neph_mask *mask = create_mask(small, "all");
    const struct neph_meter_choice choice = {neph_extractor_find("error"), {{0}}};
    struct neph_meter_params params = {.choices = &choice,
                                       .choice_count = 1,
                                       .viewing = NEPH_VIEWING_DEFAULTS,
                                       .masks = &mask,
                                       .mask_count = 1};
    struct neph_meter *meter = NULL;
    struct neph_diag diag = {0};
    params.viewing.pixels_per_degree = NAN;
    assert_int_equal(neph_meter_create(&params, &meter, &diag), NEPH_ERR_INPUT);
    assert_string_equal(diag.message, "the pixels per degree must be in 1..500, not nan");
    params.viewing = NEPH_VIEWING_DEFAULTS;
    neph_assert_ok(neph_meter_create(&params, &meter, &diag), &diag);
    assert_int_equal(neph_meter_frame(meter, small, NULL, large, &diag), NEPH_ERR_INPUT);
    assert_int_equal(neph_meter_frame(meter, large, NULL, large, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "the mask 'all' is 1x1 pixels, the images 2x1"));
    add_channel(small, "transmittance.R", NULL); /* one channel of three is not a layer */
    neph_assert_ok(neph_meter_frame(meter, small, NULL, small, &diag), &diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    assert_true(count > 0);
    for (int i = 0; i < count; i++)
        assert_string_equal(all[i].quantity->name, "radiance");
    neph_meter_destroy(meter);
    neph_mask_destroy((struct neph_mask *)mask);
    neph_image_destroy(small);
    neph_image_destroy(large);
}

static void test_tables(void **state)
{
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        assert_ptr_equal(neph_extractor_find(extractor->name), extractor);
        assert_true(strlen(extractor->help) > 0 && strlen(extractor->source) > 0);
        neph_assert_in_range(extractor->map_count, 0, NEPH_MAPS_MAX);
        for (const struct neph_metric *metric = extractor->metrics; metric->name; metric++) {
            const struct neph_extractor *owner = NULL;
            assert_ptr_equal(neph_metric_find(metric->name, &owner), metric); /* unique */
            assert_ptr_equal(owner, extractor);
            assert_true(strlen(metric->help) > 0);
            assert_true(metric->low < metric->high);
            assert_true(metric->pool == NEPH_POOL_SCALAR ||
                        (metric->map >= 0 && metric->map < extractor->map_count));
        }
    }
    assert_null(neph_extractor_at(-1));
    assert_null(neph_extractor_at(neph_extractor_count()));
    assert_null(neph_metric_find("vmaf", NULL));
    assert_int_equal(neph_quantity_count(), 4);
    assert_string_equal(neph_quantity_at(3)->name, "depth");
    assert_string_equal(neph_quantity_find("transmittance")->unit, "1");
    assert_null(neph_quantity_at(4));
    assert_null(neph_quantity_find("R"));
}

#include "tests/main.h"

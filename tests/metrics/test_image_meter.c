/* SPDX-License-Identifier: MIT
 *
 * Image metrics through the meter, over masks.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/extractors/extractors.h"

enum { WIDTH = 200, HEIGHT = 180, FENCE_STEP = 25 };

/* A fence of posts 2 px wide, 5 m away, in front of a bright ground 100 m away with a faint
 * pattern. */
static bool is_post(int x)
{
    return (x + FENCE_STEP) % FENCE_STEP < 2;
}

static struct neph_image *fence(int moved_px, double fence_radiance, double noise, uint64_t seed)
{
    struct neph_image *image = create_image(WIDTH, HEIGHT);
    float *planes[3], *depth_m = add_channel(image, "Z", NULL);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        bool post = is_post(x - moved_px);
        depth_m[i] = post ? 5.0f : 100.0f;
        for (int c = 0; c < 3; c++) {
            double ground = 0.8 + 0.05 * sin(0.09 * x) * cos(0.07 * y);
            double value = post && fence_radiance > 0.0 ? fence_radiance : ground;
            planes[c][i] = (float)(value + noise * neph_test_uniform(&seed, -1.0, 1.0));
        }
    }
    return image;
}

/* One value of an extractor over a mask of the reference. */
static const struct neph_measurement *take(const char *metric, const struct neph_image *reference,
                                           const struct neph_image *test, const char *mask_name,
                                           struct measured *measured)
{
    const struct neph_extractor *owner = NULL;
    assert_non_null(neph_metric_find(metric, &owner));
    struct neph_mask *mask = create_mask(reference, mask_name);
    *measured = measure_with(owner, reference, test, "radiance", mask);
    neph_mask_destroy(mask);
    return find(measured, metric);
}

static double number(const char *metric, const struct neph_image *reference,
                     const struct neph_image *test, const char *mask)
{
    struct measured measured;
    const struct neph_measurement *found = take(metric, reference, test, mask, &measured);
    if (!found->defined)
        fail_msg("'%s' over '%s' is undefined: %s", metric, mask, found->undefined_because);
    assert_true(isfinite(found->value) && isfinite(found->low) && isfinite(found->high));
    if (found->interval == NEPH_INTERVAL_TILES)
        assert_true(found->low <= found->value && found->value <= found->high);
    assert_true(found->value >= found->metric->low && found->value <= found->metric->high);
    return found->value;
}

static const char *reason(const char *metric, const struct neph_image *reference,
                          const struct neph_image *test, const char *mask)
{
    struct measured measured;
    const struct neph_measurement *found = take(metric, reference, test, mask, &measured);
    assert_false(found->defined);
    assert_true(found->value == 0.0);
    return found->undefined_because;
}

/* Over the edges, a fence moved by one pixel is distinguished from a missing or a pale one. */
static void test_fence_off_by_a_pixel(void **state)
{
    struct neph_image *reference = fence(0, 0.1, 0.0, 1), *moved = fence(1, 0.1, 0.01, 2),
                      *gone = fence(0, 0.0, 0.01, 3), *pale = fence(0, 0.4, 0.01, 4);
    assert_true(number("shift_gain", reference, moved, "depth_edge") < 0.2);
    assert_true(number("shift_gain", reference, moved, "thin") < 0.2);
    assert_true(number("shift_gain", reference, gone, "depth_edge") > 0.8);
    assert_true(number("shift_gain", reference, pale, "depth_edge") > 0.8);
    assert_true(number("shift_gain", reference, gone, "thin") > 0.8);
    /* Outside of the planted error, all three have the same noise. */
    neph_assert_close(number("rmse_shift1", reference, gone, "non_edge"), 0.01 / sqrt(3.0), 0.05,
                      0.0);
    neph_image_destroy(reference);
    neph_image_destroy(moved);
    neph_image_destroy(gone);
    neph_image_destroy(pale);
}

static void test_identical_images(void **state)
{
    struct neph_image *image = fence(0, 0.1, 0.0, 1);
    assert_non_null(strstr(reason("pu_psnr", image, image, "all"), "no error"));
    assert_non_null(strstr(reason("shift_gain", image, image, "all"), "no error"));
    assert_true(number("rmse_shift1", image, image, "all") == 0.0);
    assert_true(number("stops_p95", image, image, "all") == 0.0);
    assert_true(number("ssim_mean", image, image, "depth_edge") == 1.0);
    assert_true(number("ms_ssim", image, image, "all") == 1.0);
    neph_image_destroy(image);
}

/* A uniform stop is a stop everywhere; every other metric reacts as well. */
static void test_a_stop_brighter(void **state)
{
    struct neph_image *image = fence(0, 0.1, 0.0, 1), *brighter = fence(0, 0.1, 0.0, 1);
    float *planes[3];
    assert_true(neph_image_rgb(brighter, NULL, planes));
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            planes[c][i] *= 2.0f;
    static const char *const masks[] = {"all", "depth_edge", "thin", "edge_far_3_4"};
    for (size_t m = 0; m < sizeof(masks) / sizeof(masks[0]); m++) {
        /* Percentiles are of values rounded to float. */
        neph_assert_close(number("stops_mean", image, brighter, masks[m]), 1.0, 1e-12, 0.0);
        neph_assert_close(number("stops_p50", image, brighter, masks[m]), 1.0, 1e-7, 0.0);
        neph_assert_close(number("stops_p95", image, brighter, masks[m]), 1.0, 1e-7, 0.0);
        assert_true(number("ssim_mean", image, brighter, masks[m]) < 0.99);
        assert_true(number("pu_psnr", image, brighter, masks[m]) < 20.0);
    }
    neph_image_destroy(image);
    neph_image_destroy(brighter);
}

/* A NaN affects every value that depends on it: for metrics of single pixels, masks with the NaN;
 * for the others, all masks. */
static void test_a_bad_pixel(void **state)
{
    struct neph_image *reference = fence(0, 0.1, 0.0, 1), *test = fence(0, 0.1, 0.01, 2);
    float *planes[3];
    assert_true(neph_image_rgb(test, NULL, planes));
    planes[1][90 * WIDTH + 12] = NAN; /* far from any post */
    assert_non_null(strstr(reason("pu_psnr", reference, test, "all"), "not finite"));
    assert_true(number("pu_psnr", reference, test, "depth_edge") > 30.0);
    assert_true(number("stops_p95", reference, test, "depth_edge") < 0.5);
    assert_non_null(strstr(reason("ssim_mean", reference, test, "depth_edge"), "not finite"));
    assert_non_null(strstr(reason("ms_ssim", reference, test, "all"), "not finite"));
    assert_non_null(strstr(reason("shift_gain", reference, test, "depth_edge"), "not finite"));
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* SSIM has no value for a mask in the margin of 5 px. */
static void test_a_mask_in_the_margin(void **state)
{
    struct neph_image *reference = fence(0, 0.1, 0.0, 1), *test = fence(0, 0.1, 0.01, 2);
    float *margin = add_channel(reference, "mask.margin", NULL);
    for (int x = 0; x < WIDTH; x++)
        margin[4 * WIDTH + x] = 1.0f;
    assert_non_null(strstr(reason("ssim_mean", reference, test, "margin"), "11x11"));
    margin[5 * WIDTH + 5] = 1.0f;
    assert_true(number("ssim_mean", reference, test, "margin") > 0.5);
    assert_true(number("stops_p50", reference, test, "margin") > 0.0);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* A fence with another one as its volume. */
static struct neph_image *fence_in_fog(int moved_px, double noise, uint64_t seed)
{
    struct neph_image *image = fence(moved_px, 0.1, noise, seed);
    struct neph_image *fog = fence(moved_px + 7, 0.3, 2.0 * noise, seed + 100);
    float *from[3], *to[3];
    struct neph_diag diag = {0};
    assert_true(neph_image_rgb(fog, NULL, from));
    neph_assert_ok(neph_image_add_rgb(image, "volume", to, &diag), &diag);
    for (int c = 0; c < 3; c++)
        memcpy(to[c], from[c], WIDTH * HEIGHT * sizeof(float));
    neph_image_destroy(fog);
    return image;
}

/* 10 log10 of the mean of a map of squared codes, as in pu_psnr. */
static double psnr_of_map(const struct neph_meter *meter, const char *quantity)
{
    struct neph_image *map = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_meter_map(meter, neph_quantity_find(quantity), &neph_extractor_pu21, 0, &map, &diag),
        &diag);
    const float *squares = neph_image_channel(map, "Y");
    double sum = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        sum += (double)squares[i];
    neph_image_destroy(map);
    return 10.0 * log10(256.0 * 256.0 * WIDTH * HEIGHT / sum);
}

/* Codes are computed once for a pair and its quantity: two extractors, two quantities and two
 * frames together give the same bits as separately. */
static void test_shared_codes(void **state)
{
    struct neph_image *reference = fence_in_fog(0, 0.0, 1);
    struct neph_image *tests[2] = {fence_in_fog(1, 0.01, 2), fence_in_fog(2, 0.02, 3)};
    struct neph_mask *mask = create_mask(reference, "all");
    const struct neph_meter_choice choices[2] = {
        {&neph_extractor_pu21, neph_options_default(neph_extractor_pu21.options)},
        {&neph_extractor_ssim, neph_options_default(neph_extractor_ssim.options)}};
    const struct neph_meter_params params = {.choices = choices,
                                             .choice_count = 2,
                                             .viewing = NEPH_VIEWING_DEFAULTS,
                                             .masks = (const struct neph_mask *const *)&mask,
                                             .mask_count = 1};
    struct neph_meter *meter = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_meter_create(&params, &meter, &diag), &diag);
    for (int f = 0; f < 2; f++)
        neph_assert_ok(neph_meter_frame(meter, reference, NULL, tests[f], &diag), &diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    assert_int_equal(count, 2 * 2 * 4); /* pu_psnr, ssim_mean, ssim_p5, ms_ssim */
    for (int i = 0; i < count; i++) {
        const struct neph_extractor *owner = NULL;
        assert_ptr_equal(neph_metric_find(all[i].metric->name, &owner), all[i].metric);
        const struct measured alone = measure_with(owner, reference, tests[all[i].frame],
                                                   all[i].quantity->name, mask);
        assert_true(all[i].value == value_of(&alone, all[i].metric->name));
        if (owner == &neph_extractor_pu21 && all[i].frame == 1) /* squares are floats in a map */
            neph_assert_close(psnr_of_map(meter, all[i].quantity->name), all[i].value, 1e-7, 0.0);
    }
    neph_meter_destroy(meter);
    neph_mask_destroy(mask);
    neph_image_destroy(reference);
    neph_image_destroy(tests[0]);
    neph_image_destroy(tests[1]);
}

#include "tests/main.h"

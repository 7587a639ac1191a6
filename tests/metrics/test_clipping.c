/* SPDX-License-Identifier: MIT
 *
 * The share of pixels that a display clips is reported with every measure of display values, by
 * mask, frame and sequence; and two images that differ only in clipped pixels do not have an error
 * of zero.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/clipping.h"
#include "metrics/extractors/extractors.h"
#include "metrics/pooling.h"

enum { WIDTH = 16, HEIGHT = 12, ALL = WIDTH * HEIGHT, UPPER = ALL / 2, FRAMES = 4 };

/* Grey in linear light. */
static struct neph_image *grey(const float *values)
{
    struct neph_image *image = create_image(WIDTH, HEIGHT);
    float *planes[3];
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (int c = 0; c < 3; c++)
        memcpy(planes[c], values, ALL * sizeof(*values));
    return image;
}

/* `bright` in the first `count` pixels, 0.5 elsewhere; the upper half is a mask. */
static struct neph_image *partly(float bright, int count)
{
    float values[ALL], upper[ALL];
    for (int i = 0; i < ALL; i++) {
        values[i] = i < count ? bright : 0.5f;
        upper[i] = i < UPPER ? 1.0f : 0.0f;
    }
    struct neph_image *image = grey(values);
    add_channel(image, "mask.upper", upper);
    return image;
}

static struct neph_meter *start(const char *const *names, const char *setting, double exposure_ev,
                                struct neph_mask *masks[2])
{
    struct neph_meter_choice choices[8];
    struct neph_meter_params params = {.choices = choices,
                                       .viewing = NEPH_VIEWING_DEFAULTS,
                                       .masks = (const struct neph_mask *const *)masks,
                                       .mask_count = 2,
                                       .frame_count = FRAMES};
    params.viewing.exposure_ev = exposure_ev;
    for (int i = 0; names[i]; i++) {
        const struct neph_extractor *extractor = neph_extractor_find(names[i]);
        choices[i] = (struct neph_meter_choice){extractor,
                                                neph_options_default(extractor->options)};
        if (setting)
            neph_assert_ok(
                neph_options_set(extractor->options, names[i], setting, &choices[i].settings, NULL),
                NULL);
        params.choice_count++;
    }
    struct neph_meter *meter = NULL;
    neph_assert_ok(neph_meter_create(&params, &meter, NULL), NULL);
    return meter;
}

static const struct neph_measurement *number(const struct neph_meter *meter, const char *metric,
                                             const char *mask, int frame)
{
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].metric->name, metric) == 0 && strcmp(all[i].mask, mask) == 0 &&
            all[i].frame == frame)
            return &all[i];
    fail_msg("no %s over %s of frame %d", metric, mask, frame);
    return NULL;
}

static void assert_clipped(const struct neph_measurement *measured, enum neph_display_bound bound,
                           double reference, double test)
{
    assert_int_equal(measured->clipped.bound, bound);
    neph_assert_close(measured->clipped.reference, reference, 1e-12, 0.0);
    neph_assert_close(measured->clipped.test, test, 1e-12, 0.0);
}

/* 4 pixels in the reference, 8, 9, 10 and 11 in the test. */
static void test_shares_by_mask_frame_and_sequence(void **state)
{
    static const char *const names[] = {"error",           "flip",    "pu21", "ssim",
                                        "residual_change", "flicker", NULL};
    struct neph_image *reference = partly(1.5f, 4);
    struct neph_mask *masks[2] = {create_mask(reference, "all"), create_mask(reference, "upper")};
    struct neph_meter *meter = start(names, NULL, 0.0, masks);
    for (int f = 0; f < FRAMES; f++) {
        struct neph_image *test = partly(1.25f, 8 + f);
        neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, NULL), NULL);
        neph_image_destroy(test);
    }
    neph_assert_ok(neph_meter_finish(meter, NULL), NULL);
    assert_clipped(number(meter, "flip_mean", "all", 0), NEPH_BOUND_WHITE, 4.0 / ALL, 8.0 / ALL);
    assert_clipped(number(meter, "flip_mean", "upper", 3), NEPH_BOUND_WHITE, 4.0 / UPPER,
                   11.0 / UPPER);
    assert_clipped(number(meter, "flip_mean", "all", -1), NEPH_BOUND_WHITE, 4.0 / ALL, 9.5 / ALL);
    assert_clipped(number(meter, "residual_change_luma_rms", "upper", -1), NEPH_BOUND_WHITE,
                   4.0 / UPPER, 9.5 / UPPER);
    assert_clipped(number(meter, "pu_psnr", "all", 0), NEPH_BOUND_PU21, 0.0, 0.0);
    assert_clipped(number(meter, "ssim_mean", "all", 0), NEPH_BOUND_PU21, 0.0, 0.0);
    assert_clipped(number(meter, "mae", "all", 0), NEPH_BOUND_NONE, 0.0, 0.0);
    assert_clipped(number(meter, "residual_change_rms", "all", -1), NEPH_BOUND_NONE, 0.0, 0.0);
    neph_meter_destroy(meter);
    neph_mask_destroy(masks[0]);
    neph_mask_destroy(masks[1]);
    neph_image_destroy(reference);
}

/* One stop lower nothing is above white; white itself is not clipped. */
static void test_exposure_and_white_itself(void **state)
{
    static const char *const names[] = {"flip", NULL};
    static const struct {
        float value;
        double exposure_ev, share;
    } cases[] = {{1.0f, 0.0, 0.0}, {1.0000001f, 0.0, 1.0}, {2.0f, -1.0, 0.0}, {0.6f, 1.0, 1.0}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_image *image = partly(cases[i].value, ALL);
        struct neph_mask *masks[2] = {create_mask(image, "all"), create_mask(image, "upper")};
        struct neph_meter *meter = start(names, NULL, cases[i].exposure_ev, masks);
        neph_assert_ok(neph_meter_frame(meter, image, NULL, image, NULL), NULL);
        assert_clipped(number(meter, "flip_mean", "all", 0), NEPH_BOUND_WHITE, cases[i].share,
                       cases[i].share);
        neph_meter_destroy(meter);
        neph_mask_destroy(masks[0]);
        neph_mask_destroy(masks[1]);
        neph_image_destroy(image);
    }
}

/* 500 and 800 times white are 50000 and 80000 cd/m2. */
static void test_an_error_beyond_the_display_is_no_perfect_match(void **state)
{
    static const char *const names[] = {"pu21", NULL};
    struct neph_image *reference = partly(500.0f, 4), *test = partly(800.0f, 4);
    float lower[ALL] = {0.0f};
    lower[ALL - 1] = 1.0f;
    add_channel(reference, "mask.lower", lower);
    struct neph_mask *masks[2] = {create_mask(reference, "all"), create_mask(reference, "lower")};
    struct neph_meter *meter = start(names, NULL, 0.0, masks);
    neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, NULL), NULL);
    const struct neph_measurement *all = number(meter, "pu_psnr", "all", 0);
    assert_clipped(all, NEPH_BOUND_PU21, 4.0 / ALL, 4.0 / ALL);
    assert_false(all->defined);
    assert_ptr_equal(all->undefined_because, neph_pool_hidden_error);
    assert_ptr_equal(number(meter, "pu_psnr", "lower", 0)->undefined_because, neph_pool_no_error);
    neph_meter_destroy(meter);
    meter = start(names, NULL, 0.0, masks);
    neph_assert_ok(neph_meter_frame(meter, reference, NULL, reference, NULL), NULL);
    assert_ptr_equal(number(meter, "pu_psnr", "all", 0)->undefined_because, neph_pool_no_error);
    neph_meter_destroy(meter);
    neph_mask_destroy(masks[0]);
    neph_mask_destroy(masks[1]);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* Two steps of light, both above white: a change that the display does not show. */
static void test_a_change_beyond_the_display_is_no_perfect_match(void **state)
{
    static const char *const names[] = {"residual_change", NULL};
    struct neph_image *reference = partly(2.0f, ALL);
    struct neph_mask *masks[2] = {create_mask(reference, "all"), create_mask(reference, "upper")};
    struct neph_meter *meter = start(names, NULL, 0.0, masks);
    for (int f = 0; f < FRAMES; f++) {
        struct neph_image *test = partly(2.0f + (float)(f % 2), ALL);
        neph_assert_ok(neph_meter_frame(meter, reference, NULL, test, NULL), NULL);
        neph_image_destroy(test);
    }
    neph_assert_ok(neph_meter_finish(meter, NULL), NULL);
    assert_ptr_equal(number(meter, "residual_change_psnr", "all", -1)->undefined_because,
                     neph_pool_hidden_error);
    neph_meter_destroy(meter);
    neph_mask_destroy(masks[0]);
    neph_mask_destroy(masks[1]);
    neph_image_destroy(reference);
}

static void test_the_bound_of_ssim_is_that_of_its_codes(void **state)
{
    static const char *const names[] = {"ssim", NULL};
    struct neph_image *image = partly(1.5f, UPPER);
    struct neph_mask *masks[2] = {create_mask(image, "all"), create_mask(image, "upper")};
    struct neph_meter *meter = start(names, "code=display", 0.0, masks);
    neph_assert_ok(neph_meter_frame(meter, image, NULL, image, NULL), NULL);
    assert_clipped(number(meter, "ssim_mean", "all", 0), NEPH_BOUND_WHITE, 0.5, 0.5);
    neph_meter_destroy(meter);
    neph_mask_destroy(masks[0]);
    neph_mask_destroy(masks[1]);
    neph_image_destroy(image);
}

/* Colours near both bounds; PU21's upper bound is 100 at a white of 100 cd/m2. */
static void fill_about_bounds(float *const planes[3], size_t count, uint64_t *random)
{
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++)
            planes[c][i] = (float)(neph_test_uniform(random, 0.0, 1.0) < 0.9
                                       ? neph_test_uniform(random, 0.2, 1.02)
                                       : neph_test_uniform(random, 1.0, 250.0));
}

static void test_each_pixel_beyond_a_bound_is_counted(void **state)
{
    enum { WIDE = 601, ROWS = 3 };
    uint64_t random = 7;
    struct neph_image *image = create_image(WIDE, ROWS);
    float *planes[3], *part = add_channel(image, "mask.part", NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    fill_about_bounds(planes, WIDE * ROWS, &random);
    double expected[2][2] = {{0.0}}; /* by mask and bound */
    for (size_t i = 0; i < WIDE * ROWS; i++) {
        part[i] = i % 5 < 2 ? 1.0f : 0.0f;
        const double r = (double)planes[0][i], g = (double)planes[1][i], b = (double)planes[2][i];
        for (int m = 0; m < 2; m++) {
            const double inside = m == 0 || i % 5 < 2 ? 1.0 : 0.0;
            expected[m][0] += fmax(r, fmax(g, b)) > 1.0 ? inside : 0.0;
            expected[m][1] += neph_luminance(r, g, b) > 100.0 ? inside : 0.0;
        }
    }
    struct neph_mask *masks[2] = {create_mask(image, "all"), create_mask(image, "part")};
    struct neph_arena memory = {0};
    struct neph_clipping *clipping = neph_clipping_create(2, &memory);
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_frame_pair pair = {.quantity = neph_quantity_find("radiance"),
                                   .width_px = WIDE,
                                   .height_px = ROWS,
                                   .plane_count = 3,
                                   .viewing = &viewing};
    assert_true(neph_quantity_planes(pair.quantity, image, pair.reference));
    assert_true(neph_quantity_planes(pair.quantity, image, pair.test));
    neph_clipping_look(clipping, &pair, (const struct neph_mask *const *)masks);
    for (int m = 0; m < 2; m++)
        for (int b = 0; b < 2; b++) {
            const struct neph_clipped found = neph_clipping_shares(
                clipping, b ? NEPH_BOUND_PU21 : NEPH_BOUND_WHITE, masks[m], m, false);
            assert_true(expected[m][b] > 10.0);
            neph_assert_close(found.test * (double)masks[m]->pixel_count, expected[m][b], 1e-12,
                              0.0);
            assert_true(found.reference == found.test);
        }
    neph_arena_finish(&memory);
    neph_mask_destroy(masks[0]);
    neph_mask_destroy(masks[1]);
    neph_image_destroy(image);
}

#include "tests/main.h"

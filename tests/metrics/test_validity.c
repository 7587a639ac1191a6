/* SPDX-License-Identifier: MIT
 *
 * Gate G0 on images with planted faults.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/validity.h"

static struct neph_validity count(const struct neph_image *image)
{
    struct neph_validity validity;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_validity_count(image, &validity, &diag), &diag);
    return validity;
}

static void test_clean_frame_passes(void **state)
{
    struct neph_image *image = create_image(3, 1);
    add_rgb(image, NULL, (float[]){0, 1, 2, -0.0f, 4, 5, 6, 7, 8});
    add_channel(image, "Z", (float[]){1, INFINITY, 3});
    struct neph_validity validity = count(image);
    assert_int_equal(validity.channel_count, 4);
    assert_int_equal(validity.non_finite_count, 0);
    assert_int_equal(validity.negative_count, 0);
    assert_string_equal(validity.channels[3].name, "Z");
    assert_int_equal(validity.channels[3].positive_infinity_count, 0);
    assert_true(validity.channels[3].min == 1.0f && validity.channels[3].max == 3.0f);
    assert_true(validity.channels[1].min == 1.0f && validity.channels[1].max == 7.0f);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_validity_gate(&validity, 0, &diag), &diag);
    neph_validity_finish(&validity);
    neph_image_destroy(image);
}

static void test_planted_faults_are_counted(void **state)
{
    struct neph_image *image = create_image(3, 2);
    add_channel(image, "R", (float[]){1, NAN, INFINITY, NAN, -INFINITY, -2});
    add_channel(image, "transmittance.G", (float[]){1, -1e-30f, 0, -1, 1, 1});
    add_channel(image, "Z", (float[]){INFINITY, 1, NAN, -INFINITY, -3, 2});
    add_channel(image, "motion.X", (float[]){-1, -2, -3, -4, NAN, 0});
    struct neph_validity validity = count(image);

    const struct neph_validity_channel *red = &validity.channels[0];
    assert_int_equal(red->nan_count, 2);
    assert_int_equal(red->positive_infinity_count, 1);
    assert_int_equal(red->negative_infinity_count, 1);
    assert_int_equal(red->non_finite_count, 4);
    assert_int_equal(red->first_non_finite.x_px, 1);
    assert_int_equal(red->first_non_finite.y_px, 0);
    assert_int_equal(red->negative_count, 1);
    assert_int_equal(red->first_negative.x_px, 2);
    assert_int_equal(red->first_negative.y_px, 1);
    assert_true(red->min == -2.0f && red->max == 1.0f);

    const struct neph_validity_channel *clear = &validity.channels[1];
    assert_int_equal(clear->non_finite_count, 0);
    assert_int_equal(clear->negative_count, 2);
    assert_int_equal(clear->first_negative.x_px, 1);

    const struct neph_validity_channel *depth = &validity.channels[2];
    assert_int_equal(depth->nan_count, 1);
    assert_int_equal(depth->positive_infinity_count, 0);
    assert_int_equal(depth->negative_infinity_count, 1);
    assert_int_equal(depth->negative_count, 1);

    assert_int_equal(validity.channels[3].negative_count, 0);
    assert_int_equal(validity.channels[3].nan_count, 1);
    assert_int_equal(validity.non_finite_count, 4 + 2 + 1);
    assert_int_equal(validity.negative_count, 1 + 2 + 1);

    struct neph_diag diag = {0};
    assert_int_equal(neph_validity_gate(&validity, SIZE_MAX, &diag), NEPH_ERR_GATE);
    assert_non_null(strstr(diag.message, "7 values in 3 of 4 channels are not finite"));
    assert_non_null(strstr(diag.message, "'R' at pixel (1, 0)"));
    assert_non_null(strstr(diag.message, "2 NaN, 1 +inf and 1 -inf"));
    neph_validity_finish(&validity);
    neph_image_destroy(image);
}

/* Rows are tested in vectors first: a single odd value anywhere in a row must be found. */
static void test_one_fault_in_a_long_row(void **state)
{
    enum { WIDTH = 67, HEIGHT = 3 };
    const struct {
        float value;
        size_t non_finite, negative;
    } faults[] = {{NAN, 1, 0},   {-NAN, 1, 0},    {INFINITY, 1, 0}, {-INFINITY, 1, 0},
                  {-1.0f, 0, 1}, {-1e-45f, 0, 1}, {-0.0f, 0, 0},    {0.0f, 0, 0}};
    float values[WIDTH * HEIGHT];
    for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++)
        for (int x = 0; x < WIDTH; x++) {
            for (int p = 0; p < WIDTH * HEIGHT; p++)
                values[p] = 1.0f + (float)p;
            values[WIDTH + x] = faults[i].value;
            struct neph_image *image = create_image(WIDTH, HEIGHT);
            add_channel(image, "R", values);
            struct neph_validity validity = count(image);
            const struct neph_validity_channel *red = &validity.channels[0];
            assert_int_equal(red->non_finite_count, faults[i].non_finite);
            assert_int_equal(red->negative_count, faults[i].negative);
            const struct neph_validity_pixel *at = red->non_finite_count ? &red->first_non_finite
                                                                         : &red->first_negative;
            assert_int_equal(at->x_px, faults[i].non_finite + faults[i].negative ? x : 0);
            assert_int_equal(at->y_px, faults[i].non_finite + faults[i].negative ? 1 : 0);
            assert_true(red->min == (isfinite(faults[i].value) ? faults[i].value : 1.0f));
            assert_true(red->max == (float)(WIDTH * HEIGHT));
            neph_validity_finish(&validity);
            neph_image_destroy(image);
        }
}

static void test_negative_values_have_an_allowance(void **state)
{
    struct neph_image *image = create_image(2, 1);
    add_channel(image, "R", (float[]){1, 1});
    add_channel(image, "volume.B", (float[]){-0.25f, -0.5f});
    struct neph_validity validity = count(image);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_validity_gate(&validity, 2, &diag), &diag);
    assert_int_equal(neph_validity_gate(&validity, 1, &diag), NEPH_ERR_GATE);
    assert_non_null(strstr(diag.message, "2 values in 1 of 2 channels are negative, 1 allowed"));
    assert_non_null(
        strstr(diag.message, "'volume.B' at pixel (0, 0); minimum of that channel: -0.5"));
    assert_int_equal(neph_validity_gate(&validity, 0, NULL), NEPH_ERR_GATE);
    neph_validity_finish(&validity);
    neph_image_destroy(image);
}

static void test_channel_of_nothing_finite(void **state)
{
    struct neph_image *image = create_image(1, 1);
    add_channel(image, "Z", (float[]){INFINITY});
    struct neph_validity validity = count(image);
    assert_false(validity.channels[0].has_finite);
    assert_true(validity.channels[0].min == 0.0f && validity.channels[0].max == 0.0f);
    neph_validity_finish(&validity);
    neph_image_destroy(image);

    image = create_image(1, 1); /* no channels at all */
    validity = count(image);
    assert_int_equal(validity.channel_count, 0);
    neph_assert_ok(neph_validity_gate(&validity, 0, NULL), NULL);
    neph_validity_finish(&validity);
    neph_image_destroy(image);
}

static void test_mismatches_are_named(void **state)
{
    struct neph_image *reference = create_image(4, 3), *test = create_image(3, 4);
    struct neph_diag diag = {0};
    assert_int_equal(neph_validity_same_size(reference, test, &diag), NEPH_ERR_INPUT);
    assert_string_equal(diag.message, "the reference is 4x3 pixels, the test 3x4");
    neph_assert_ok(neph_validity_same_size(reference, reference, &diag), &diag);
    neph_image_destroy(test);

    test = create_image(4, 3);
    add_channel(reference, "R", NULL);
    add_channel(reference, "Z", NULL);
    add_channel(test, "R", NULL);
    assert_int_equal(neph_validity_same_channels(reference, test, &diag), NEPH_ERR_INPUT);
    assert_string_equal(diag.message,
                        "the channels differ: 1 only in the reference: 'Z'; 0 only in the test");
    add_channel(test, "A", NULL);
    assert_int_equal(neph_validity_same_channels(reference, test, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "1 only in the test: 'A'"));
    neph_assert_ok(neph_validity_same_channels(test, test, &diag), &diag);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* Which channels must not be negative; only distances may be infinite. */
static void test_rules_of_channels(void **state)
{
    static const struct {
        const char *name;
        int negative_count, non_finite_count; /* of one -1 and one +inf */
    } cases[] = {
        {"R", 1, 1},
        {"G", 1, 1},
        {"B", 1, 1},
        {"volume.R", 1, 1},
        {"Z", 1, 0},
        {"transmittance.B", 1, 1},
        {"ZBack", 0, 1},
        {"variance.G", 1, 1},
        {"volumes", 0, 1},
        {"normal.X", 0, 1},
        {"volume.distance", 1, 0},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_image *image = create_image(2, 1);
        add_channel(image, cases[i].name, (float[]){-1, INFINITY});
        struct neph_validity validity = count(image);
        assert_int_equal(validity.negative_count, cases[i].negative_count);
        assert_int_equal(validity.non_finite_count, cases[i].non_finite_count);
        neph_validity_finish(&validity);
        neph_image_destroy(image);
    }
}

/* A list of names longer than the message is truncated without overrun. */
static void test_many_missing_channels(void **state)
{
    struct neph_image *reference = create_image(1, 1), *test = create_image(1, 1);
    for (int i = 0; i < 100; i++) {
        char name[32];
        snprintf(name, sizeof(name), "a long name for channel %d", i);
        add_channel(reference, name, NULL);
    }
    struct neph_diag diag = {0};
    assert_int_equal(neph_validity_same_channels(reference, test, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "100 only in the reference"));
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* ---- frozen frames --------------------------------------------------------------------------- */

static void test_frozen_frames_are_counted(void **state)
{
    struct neph_image *images[2] = {create_image(5, 3), create_image(5, 3)};
    float *red[2], *green[2];
    for (int i = 0; i < 2; i++) {
        red[i] = add_channel(images[i], "R", NULL);
        green[i] = add_channel(images[i], "G", NULL);
    }
    struct neph_frozen frozen = {0};
    assert_false(neph_frozen_add(&frozen, NULL, images[0]));
    red[1][14] = 0x1p-149f; /* the smallest possible change */
    assert_false(neph_frozen_add(&frozen, images[0], images[1]));
    red[0][14] = red[1][14];
    assert_true(neph_frozen_add(&frozen, images[1], images[0]));
    assert_true(neph_frozen_add(&frozen, images[0], images[1]));
    green[0][14] = red[0][14];
    red[0][14] = 0.0f; /* the same samples in another channel are another frame */
    assert_false(neph_frozen_add(&frozen, images[1], images[0]));
    assert_int_equal(frozen.frame_count, 5);
    assert_int_equal(frozen.frozen_count, 2);
    assert_int_equal(frozen.first_frozen, 2);
    neph_image_destroy(images[0]);
    neph_image_destroy(images[1]);
}

/* NaN and the sky are treated like other samples. */
static void test_samples_are_compared_by_their_bits(void **state)
{
    struct neph_image *images[2] = {create_image(1, 1), create_image(1, 1)};
    add_channel(images[0], "Z", (float[]){INFINITY});
    add_channel(images[1], "Z", (float[]){NAN});
    for (int i = 0; i < 2; i++) {
        assert_true(neph_frames_are_equal(images[i], images[i]));
        assert_false(neph_frames_are_equal(images[i], images[1 - i]));
    }
    neph_image_destroy(images[0]);
    neph_image_destroy(images[1]);
    images[0] = create_image(1, 1);
    images[1] = create_image(1, 1);
    add_channel(images[0], "Z", (float[]){0.0f});
    add_channel(images[1], "Z", (float[]){-0.0f});
    assert_false(neph_frames_are_equal(images[0], images[1]));
    neph_image_destroy(images[0]);
    neph_image_destroy(images[1]);
}

/* Size and names count, attributes do not. */
static void test_what_is_compared(void **state)
{
    struct neph_image *wide = create_image(6, 1), *high = create_image(1, 6),
                      *named = create_image(6, 1);
    add_channel(wide, "R", NULL);
    add_channel(high, "R", NULL);
    add_channel(named, "G", NULL);
    char of_wide[NEPH_HASH_HEX_SIZE], other[NEPH_HASH_HEX_SIZE];
    neph_assert_ok(neph_frozen_hash(wide, of_wide, NULL), NULL);
    neph_assert_ok(neph_frozen_hash(high, other, NULL), NULL);
    assert_string_not_equal(of_wide, other);
    assert_false(neph_frames_are_equal(wide, high) || neph_frames_are_equal(wide, named));
    neph_assert_ok(neph_frozen_hash(named, other, NULL), NULL);
    assert_string_not_equal(of_wide, other);
    neph_assert_ok(neph_image_set_attribute(wide, "time", NULL, "%d", 7), NULL);
    neph_assert_ok(neph_frozen_hash(wide, other, NULL), NULL);
    assert_string_equal(of_wide, other);
    neph_image_destroy(wide);
    neph_image_destroy(high);
    neph_image_destroy(named);
}

#include "tests/main.h"

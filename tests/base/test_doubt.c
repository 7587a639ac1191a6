/* SPDX-License-Identifier: MIT
 *
 * Whether the error bar of a frame is to be trusted, from the variances of its pixels.
 */
#include "tests/neph_test.h"

#include "base/doubt.h"

/* N equal pixels have 1/N of the doubt of one; a pixel with most of the variance has its own. */
static void test_doubt_of_a_frame(void **state)
{
    struct neph_doubt even = {.noisy = 0}, uneven = {.noisy = 0}, none = {.noisy = 0};
    for (int i = 0; i < 100; i++) {
        neph_doubt_add(&even, 3.0, 0.5);
        neph_doubt_add(&uneven, i == 7 ? 1e9 : 3.0, i == 7 ? 0.9 : 0.05);
        neph_doubt_add(&none, 0.0, NAN);
    }
    neph_assert_close(neph_doubt_of_frame(&even), 0.005, 1e-12, 0.0);
    assert_int_equal(even.doubtful, 100);
    neph_assert_close(neph_doubt_of_frame(&uneven), 0.9, 1e-6, 0.0);
    assert_int_equal(uneven.doubtful, 1);
    assert_true(neph_doubt_of_frame(&none) == 0.0);
    assert_int_equal(none.noisy, 0);
    neph_doubt_add(&even, INFINITY, NAN);
    assert_true(neph_doubt_of_frame(&even) == 1.0);
}

static void test_attributes(void **state)
{
    struct neph_diag diag = {0};
    struct neph_image *frame = NULL;
    neph_assert_ok(neph_image_create(1, 1, &frame, &diag), &diag);
    assert_true(isnan(neph_doubt_read(frame)));
    const struct neph_doubt doubt = {.variance = 2.0, .squares = 1.0, .noisy = 8, .doubtful = 2};
    neph_assert_ok(neph_doubt_label(frame, &doubt, &diag), &diag);
    assert_true(neph_doubt_read(frame) == 0.25);
    assert_string_equal(neph_image_attribute(frame, "neph.noise.doubtful_pixels"), "0.25");
    static const char *const damaged[] = {"", "much", "-1", "nan"};
    for (size_t i = 0; i < sizeof(damaged) / sizeof(damaged[0]); i++) {
        neph_assert_ok(neph_image_set_attribute(frame, "neph.noise.doubt", &diag, "%s", damaged[i]),
                       &diag);
        assert_true(isnan(neph_doubt_read(frame)));
    }
    neph_image_destroy(frame);
}

static void test_words(void **state)
{
    char text[NEPH_DOUBT_ROOM];
    neph_doubt_describe(0.41, text, sizeof(text));
    assert_non_null(strstr(text, "error bar not trusted"));
    assert_non_null(strstr(text, "0.41, above 0.1); take more samples"));
    neph_doubt_describe(1.234e-300, text, sizeof(text));
    assert_string_equal(text, "");
    neph_doubt_describe(NAN, text, sizeof(text));
    assert_string_equal(text, "");
    neph_doubt_describe(-1.234e300, text, sizeof(text));
    assert_string_equal(text, "");
    neph_doubt_describe(1.234e300, text, sizeof(text));
    assert_true(strlen(text) < sizeof(text) - 1);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Two renderers with known difference and known noise.
 */
#include "tests/neph_test.h"

#include "metrics/pair.h"

enum { WIDTH = 96, HEIGHT = 54, PIXELS = WIDTH * HEIGHT };

static double normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 1e-300, 1.0);
    return sqrt(-2.0 * log(u)) * cos(neph_test_uniform(random, 0.0, 6.283185307179586));
}

/* A smooth image of mean 1, times `gain`, with an added checkered pattern and noise. */
static struct neph_image *frame(double gain, double pattern, double noise, uint64_t *random)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    for (int p = 0; p < PIXELS; p++)
        for (int c = 0; c < 3; c++) {
            const double sign = (p % WIDTH + p / WIDTH) % 2 ? 1.0 : -1.0;
            const double value = 1.0 + 0.5 * sin(6.283185307179586 * (p % WIDTH) / WIDTH);
            planes[c][p] = (float)(gain * value + pattern * sign + noise * normal(random));
        }
    return image;
}

static struct neph_pair compare(double gain, double pattern, double noise, uint64_t seed)
{
    struct neph_diag diag = {0};
    struct neph_image *images[4] = {frame(gain, pattern, noise, &seed),
                                    frame(gain, pattern, noise, &seed),
                                    frame(1.0, 0.0, noise, &seed), frame(1.0, 0.0, noise, &seed)};
    const struct neph_image *const frames[4] = {images[0], images[1], images[2], images[3]};
    struct neph_mask *mask = NULL;
    struct neph_pair pair;
    neph_assert_ok(neph_mask_create(images[0], "all", NULL, &mask, &diag), &diag);
    neph_assert_ok(neph_pair_compare(frames, mask, 1.96, &pair, &diag), &diag);
    neph_mask_destroy(mask);
    for (int i = 0; i < 4; i++)
        neph_image_destroy(images[i]);
    return pair;
}

static void test_noise_is_not_a_difference(void **state)
{
    const struct neph_pair pair = compare(1.0, 0.0, 0.2, 7);
    /* The difference of means of two frames each has noise 0.2 per pixel; 15552 samples. */
    neph_assert_close(pair.noise_floor, 0.2, 0.05, 0.0);
    assert_true(fabs(pair.mean_difference) < 5.0 * 0.2 / sqrt(3.0 * PIXELS));
    assert_true(pair.rms_difference < 0.2 / 2.0);
    assert_true(pair.verdict != NEPH_PAIR_DIFFER);
}

static void test_gain_shows(void **state)
{
    const struct neph_pair pair = compare(1.05, 0.0, 0.05, 8);
    /* 2 (1.05 - 1) / (1.05 + 1) */
    neph_assert_close(pair.mean_difference, 0.0488, 0.0, 0.002);
    assert_true(pair.mean_low > 0.04 && pair.verdict == NEPH_PAIR_DIFFER);
    assert_string_equal(neph_pair_verdict_name(pair.verdict), "differ");
}

/* A pattern of mean 0 is invisible in the mean and clear in the rms, below its own noise. */
static void test_pattern_below_the_noise(void **state)
{
    const struct neph_pair pair = compare(1.0, 0.05, 0.1, 9);
    neph_assert_close(pair.rms_difference, 0.05, 0.1, 0.0);
    assert_true(pair.noise_floor > pair.rms_difference);
    assert_true(pair.verdict == NEPH_PAIR_DIFFER);
}

static void test_agreement_needs_quiet(void **state)
{
    assert_int_equal(compare(1.0, 0.0, 1e-4, 10).verdict, NEPH_PAIR_AGREE);
    assert_int_equal(compare(1.00001, 0.0, 0.0, 11).verdict, NEPH_PAIR_AGREE);
    assert_int_equal(compare(1.0, 0.0, 0.5, 12).verdict, NEPH_PAIR_CANNOT_TELL);
}

static void test_bad_pixels_are_an_error(void **state)
{
    uint64_t seed = 13;
    struct neph_diag diag = {0};
    struct neph_image *image = frame(1.0, 0.0, 0.0, &seed);
    struct neph_mask *mask = NULL;
    struct neph_pair pair;
    neph_assert_ok(neph_mask_create(image, "all", NULL, &mask, &diag), &diag);
    neph_image_channel(image, "G")[100] = NAN;
    const struct neph_image *const frames[4] = {image, image, image, image};
    assert_int_equal(neph_pair_compare(frames, mask, 1.96, &pair, &diag), NEPH_ERR_GATE);
    neph_mask_destroy(mask);
    neph_image_destroy(image);
}

#include "tests/main.h"

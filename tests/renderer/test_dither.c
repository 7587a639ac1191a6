/* SPDX-License-Identifier: MIT
 *
 * Dither kinds against their published formulas, worked out by other means: interleaved gradient
 * noise in rational arithmetic, the hash in Python's integers. Needs no Vulkan.
 */
#include "tests/base/scratch.h"

#include "renderer/blue_noise.h"
#include "renderer/dither.h"

static struct neph_dither *open_dither(enum neph_dither_kind kind, uint32_t seed,
                                       const char *folder)
{
    struct neph_dither *dither = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_dither_create(kind, seed, folder, &dither, &diag), &diag);
    return dither;
}

static void test_names(void **state)
{
    (void)state;
    for (int i = 0; i < NEPH_DITHER_KIND_COUNT; i++) {
        enum neph_dither_kind found = NEPH_DITHER_KIND_COUNT;
        assert_true(neph_dither_find(neph_dither_name((enum neph_dither_kind)i), &found));
        assert_int_equal(found, i);
    }
    enum neph_dither_kind untouched = NEPH_DITHER_BLUE;
    assert_false(neph_dither_find("pink", &untouched));
    assert_false(neph_dither_find("", &untouched));
    assert_int_equal(untouched, NEPH_DITHER_BLUE);
}

/* A double's rounding of arguments up to 300, 53 times larger: 53 * 2^-44. */
static const double gradient_rounding = 53 * 0x1p-44;

static void test_interleaved_gradient_values(void **state)
{
    (void)state;
    static const struct {
        int x, y;
        uint32_t frame;
        double value;
    } known[] = {
        {0, 0, 0, 0.0},
        {1, 0, 0, 0.555713357813584},
        {0, 1, 0, 0.309269245057135},
        {-1, 0, 0, 0.427205542186416},
        {1919, 1079, 0, 0.421397560916361},
        {3, 5, 7, 0.453828153633854},
        {3, 5, 71, 0.453828153633854}, /* 64 frames later */
        {0, 0, 63, 0.128914494166843},
    };
    struct neph_dither *dither = open_dither(NEPH_DITHER_INTERLEAVED, 0, NULL);
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
        neph_assert_close(neph_dither_value(dither, known[i].x, known[i].y, known[i].frame),
                          known[i].value, 0.0, gradient_rounding);
    neph_dither_destroy(dither);
}

static int compare(const void *a, const void *b)
{
    const double first = *(const double *)a, second = *(const double *)b;
    return (first > second) - (first < second);
}

/* What Jimenez made it for: the nine values of any 3x3 window lie round the circle with gaps near
 * 1/9. With his constants the widest is 0.135018 (rational arithmetic); of white noise's nine the
 * widest has mean (1 + 1/2 + ... + 1/9) / 9 = 0.31. */
static void test_interleaved_windows_cover_the_circle(void **state)
{
    (void)state;
    struct neph_dither *dither = open_dither(NEPH_DITHER_INTERLEAVED, 0, NULL);
    for (int i = 0; i < 100 * 100; i++) {
        double values[10], widest = 0.0;
        for (int k = 0; k < 9; k++)
            values[k] = neph_dither_value(dither, i % 100 + k % 3, i / 100 + k / 3, 5);
        qsort(values, 9, sizeof(double), compare);
        values[9] = values[0] + 1.0;
        for (int k = 0; k < 9; k++)
            widest = fmax(widest, values[k + 1] - values[k]);
        assert_true(widest < 0.13502);
    }
    neph_dither_destroy(dither);
}

static void test_white_values(void **state)
{
    (void)state;
    static const struct {
        int x, y;
        uint32_t frame, seed, word;
    } known[] = {
        {0, 0, 0, 0, 0x0f02f829u},
        {1, 2, 3, 4, 0x3622cd16u},
        {-1, 0, 0, 0, 0x0394ccb3u},
        {1919, 1079, 100, 7, 0x8954e262u},
    };
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
        struct neph_dither *dither = open_dither(NEPH_DITHER_WHITE, known[i].seed, NULL);
        const double value = neph_dither_value(dither, known[i].x, known[i].y, known[i].frame);
        assert_true(value == ((known[i].word >> 9) + 0.5) / 8388608.0);
        assert_true(value == (double)(float)value);
        neph_dither_destroy(dither);
    }
}

/* Moments of 2^16 values and of neighbours' products, in all three directions, within 5 standard
 * deviations: sd(mean) = sqrt(1/12 / n), sd(mean square) = sqrt(1/180 / n), sd(product) = 1/12 /
 * sqrt(n). */
static void test_white_is_white(void **state)
{
    (void)state;
    struct neph_dither *dither = open_dither(NEPH_DITHER_WHITE, 3, NULL);
    double mean = 0.0, square = 0.0, product[3] = {0.0};
    enum { COUNT = 1 << 16 };
    for (int i = 0; i < COUNT; i++) {
        const int x = i % 64 - 32, y = i / 64 % 64 - 32;
        const uint32_t frame = (uint32_t)(i / 4096);
        const double value = neph_dither_value(dither, x, y, frame) - 0.5;
        mean += value / COUNT;
        square += value * value / COUNT;
        product[0] += value * (neph_dither_value(dither, x + 1, y, frame) - 0.5) / COUNT;
        product[1] += value * (neph_dither_value(dither, x, y + 1, frame) - 0.5) / COUNT;
        product[2] += value * (neph_dither_value(dither, x, y, frame + 1) - 0.5) / COUNT;
    }
    neph_assert_close(mean, 0.0, 0.0, 5 * sqrt(1 / 12.0 / COUNT));
    neph_assert_close(square, 1 / 12.0, 0.0, 5 * sqrt(1 / 180.0 / COUNT));
    for (int i = 0; i < 3; i++)
        neph_assert_close(product[i], 0.0, 0.0, 5 / 12.0 / sqrt(COUNT));
    neph_dither_destroy(dither);
}

/* Blue goes on by the golden ratio in steps of 2^-32, also where the frame times the step passes
 * 2^32; frame 0 is the mask itself. */
static void test_blue_goes_on_by_the_golden_ratio(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_dither *dither = open_dither(NEPH_DITHER_BLUE, 5, scratch->folder);
    struct neph_blue_noise *mask = NULL;
    neph_assert_ok(
        neph_blue_noise_create(&(struct neph_blue_noise_request){64, 64, 1, 5}, &mask, NULL), NULL);
    const uint32_t frames[] = {0, 1, 2, 3, 1000, UINT32_MAX};
    for (size_t i = 0; i < sizeof(frames) / sizeof(frames[0]); i++)
        for (int pixel = 0; pixel < 64 * 64; pixel++) {
            /* All in integers, modulo 2^32, as a shader does it. */
            const uint32_t bits = (2u * mask->ranks[pixel] + 1u) * (1u << 19) +
                                  frames[i] * 2654435769u;
            assert_true(neph_dither_value(dither, pixel % 64, pixel / 64 - 64, frames[i]) ==
                        bits * 0x1p-32);
        }
    const double golden_ratio = 0.5 * (1.0 + sqrt(5.0));
    neph_assert_close(2654435769u * 0x1p-32, 1.0 / golden_ratio, 0.0, 0x1p-33);
    neph_blue_noise_destroy(mask);
    neph_dither_destroy(dither);
}

/* For any pixel and frame that there is. The spatiotemporal kind is all in the next test. */
static void test_values_stay_within_the_unit_interval(void **state)
{
    const struct scratch *scratch = *state;
    for (int kind = 0; kind < NEPH_DITHER_SPATIOTEMPORAL; kind++) {
        struct neph_dither *dither = open_dither((enum neph_dither_kind)kind, 1, scratch->folder);
        uint64_t seed = 17;
        for (int i = 0; i < 20000; i++) {
            const uint64_t word = neph_test_random(&seed), frame = neph_test_random(&seed);
            const double value = neph_dither_value(dither, (int)(uint32_t)word, (int)(word >> 32),
                                                   (uint32_t)frame);
            assert_true(value >= 0.0 && value < 1.0);
        }
        neph_dither_destroy(dither);
    }
}

static void test_spatiotemporal_is_the_full_mask(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_dither *dither = open_dither(NEPH_DITHER_SPATIOTEMPORAL, 2, scratch->folder);
    struct neph_blue_noise *mask = NULL;
    neph_assert_ok(neph_blue_noise_load(&(struct neph_blue_noise_request){64, 64, 32, 2},
                                        scratch->folder, &mask, NULL),
                   NULL);
    assert_int_equal(scratch_count(state), 1); /* one file for both */
    for (int i = 0; i < 64 * 64 * 32; i++)
        assert_true(
            neph_dither_value(dither, i % 64 - 64, i / 64 % 64 + 64, (uint32_t)(i / 4096) + 32) ==
            (mask->ranks[i] + 0.5) / 4096.0);
    neph_blue_noise_destroy(mask);
    neph_dither_destroy(dither);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_interleaved_gradient_values),
        cmocka_unit_test(test_interleaved_windows_cover_the_circle),
        cmocka_unit_test(test_white_values),
        cmocka_unit_test(test_white_is_white),
        scratch_test(test_blue_goes_on_by_the_golden_ratio),
        scratch_test(test_values_stay_within_the_unit_interval),
        scratch_test(test_spatiotemporal_is_the_full_mask),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

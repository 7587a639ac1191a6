/* SPDX-License-Identifier: MIT
 *
 * Flicker with a static camera: closed forms of pure signals, moments of white noise, and the
 * definitions evaluated frame by frame.
 */
#include "tests/metrics/flicker_test.h"

#include "metrics/extractors/display_luma.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flicker_spectrum.h"
#include "metrics/extractors/flicker_verdict.h"
#include "metrics/extractors/phase_age.h"

#include <sched.h>

/* The luma of a stored sample differs from the intended one by the rounding of the linear float,
 * 2^-24 of it. The encoding multiplies this by at most 1 (12.92 c / 12.92 c; less above the step).
 * Amplitudes are means of such errors. */
static const double of_float = 0x1p-24;

/* The encoding is accurate to 2e-15; differences and sums of 200 frames lose at most two digits. */
static const double of_double = 2e-13;

/* ---- signal ---------------------------------------------------------------------------------- */

static void test_luma_is_that_of_the_standard(void **state)
{
    enum { N = 20000 };
    uint64_t random = 11;
    for (int i = 0; i < N; i++) {
        /* All octaves of 2^-40 .. 2^4 and both signs. */
        struct sequence pixel = sequence_create(1, 1, 1);
        for (int c = 0; c < 3; c++) {
            const double size = exp2(neph_test_uniform(&random, -40.0, 4.0));
            *sequence_plane(&pixel, 0, c) = (float)(i % 16 == c ? -size : size);
        }
        const float *const rgb[3] = {sequence_plane(&pixel, 0, 0), sequence_plane(&pixel, 0, 1),
                                     sequence_plane(&pixel, 0, 2)};
        double luma = NAN, luminance = NAN;
        neph_display_luma(rgb, 1, exp2(-1.5), &luma, &luminance);
        neph_assert_close(luma, (double)luma_of(&pixel, 0, 0, 0, -1.5), 2e-15, 0.0);
        sequence_destroy(&pixel);
    }
}

static void test_luma_at_its_ends(void **state)
{
    const float values[][2] = {{0.0f, 0.0f},   {-1.0f, 0.0f}, {1.0f, 1.0f},          {1e30f, 1.0f},
                               {-3e38f, 0.0f}, {3e38f, 1.0f}, {0x1p-149f, 0x1p-149f}};
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
        const float *const rgb[3] = {values[i], values[i], values[i]};
        double luma = NAN, luminance = NAN;
        neph_display_luma(rgb, 1, 1.0, &luma, &luminance);
        neph_assert_close(luminance, (double)values[i][1], 1e-15, 0.0);
        const double expected = i == 6 ? 12.92 * 0x1p-149 : (double)values[i][1];
        neph_assert_close(luma, expected, 2e-15, 0.0);
    }
}

/* ---- pure signals ---------------------------------------------------------------------------- */

/* A grey equal to frame 0 of `test`: d starts at 0 as the signal does. */
static struct sequence still(int width_px, int height_px, double luma)
{
    struct sequence reference = sequence_create(width_px, height_px, 1);
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++)
            sequence_set_luma(&reference, 0, x, y, luma);
    return reference;
}

/* x = 0.5 + A cos(pi t / 2 + phase), a pixel per phase: a4 = A, std = A / sqrt 2, and the cycle's
 * share is 1. */
static void test_period_of_four(void **state)
{
    enum { PHASES = 23, N = 32 };
    const double amplitude = 0.2;
    struct sequence reference = still(PHASES, 1, 0.3), test = sequence_create(PHASES, 1, N);
    for (int t = 0; t < N; t++)
        for (int p = 0; p < PHASES; p++)
            sequence_set_luma(&test, t, p, 0,
                              0.5 + amplitude * cos(0.5 * M_PI * t + 2.0 * M_PI * p / PHASES));
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    double *a4 = flicker_map(&run, "a4"), *a2 = flicker_map(&run, "a2");
    double *std = flicker_map(&run, "std"), *share = flicker_map(&run, "cycle_share");
    double *cyclic = flicker_map(&run, "cyclic");
    for (int p = 0; p < PHASES; p++) {
        neph_assert_close(a4[p], amplitude, 1e-6, 0.0);
        neph_assert_close(a2[p], 0.0, 0.0, 2.0 * of_float);
        neph_assert_close(std[p], amplitude / sqrt(2.0), 1e-6, 0.0);
        neph_assert_close(share[p], 1.0, 1e-6, 0.0);
        assert_true(cyclic[p] == 1.0);
    }
    free(a4);
    free(a2);
    free(std);
    free(share);
    free(cyclic);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* x = 0.5 + A cos(pi t + phase): every other frame, a2 = A |cos phase| = std, p2p and mad 2 a2. */
static void test_period_of_two(void **state)
{
    enum { PHASES = 7, N = 16 };
    const double amplitude = 0.1;
    struct sequence reference = still(PHASES, 1, 0.5), test = sequence_create(PHASES, 1, N);
    for (int t = 0; t < N; t++)
        for (int p = 0; p < PHASES; p++)
            sequence_set_luma(&test, t, p, 0, 0.5 + amplitude * cos(M_PI * t + 0.2 * M_PI * p));
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    for (int p = 0; p < PHASES; p++) {
        const double expected = amplitude * fabs(cos(0.2 * M_PI * p));
        neph_assert_close(flicker_at(&run, "a2", p, 0), expected, 1e-6, 2.0 * of_float);
        neph_assert_close(flicker_at(&run, "a4", p, 0), 0.0, 0.0, 2.0 * of_float);
        neph_assert_close(flicker_at(&run, "std", p, 0), expected, 1e-6, 2.0 * of_float);
        neph_assert_close(flicker_at(&run, "p2p", p, 0), 2.0 * expected, 1e-6, 2.0 * of_float);
        neph_assert_close(flicker_at(&run, "mad", p, 0), 2.0 * expected, 1e-6, 2.0 * of_float);
    }
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* One frame in four: h, 0, 0, 0 has h / 4 in each part, a4 = h / 2 and a2 = h / 4. Both lumas
 * belong to exact floats, so the closed form is valid to double precision. */
static void test_blink(void **state)
{
    enum { N = 20 };
    struct sequence reference = sequence_create(1, 1, 1), test = sequence_create(1, 1, N);
    sequence_set(&reference, 0, 0, 0, 0.25, 0.25, 0.25);
    for (int t = 0; t < N; t++)
        sequence_set(&test, t, 0, 0, t % 4 ? 0.25 : 0.75, 0.25, 0.25);
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    const double height = (double)(luma_of(&test, 0, 0, 0, 0.0) - luma_of(&test, 1, 0, 0, 0.0));
    neph_assert_close(flicker_at(&run, "a4", 0, 0), height / 2.0, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "a2", 0, 0), height / 4.0, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "std", 0, 0), height * sqrt(3.0) / 4.0, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "mad", 0, 0), height * 9.0 / 19.0, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "cycle_share", 0, 0), 1.0, 1e-11, 0.0);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* In the dark the luma is 12.92 times the linear value, and multiples of 2^-16 are exact: a ramp
 * without rounding. Without detrending, sqrt(2) and 1/2 of its slope leak into a4 and a2. */
static void test_ramp(void **state)
{
    enum { N = 128 };
    const double slope = 12.92 * 0x1p-16;
    struct sequence reference = sequence_create(1, 1, 1), test = sequence_create(1, 1, N);
    for (int t = 0; t < N; t++)
        sequence_set(&test, t, 0, 0, (t + 20) * 0x1p-16, (t + 20) * 0x1p-16, (t + 20) * 0x1p-16);
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    neph_assert_close(flicker_at(&run, "a4", 0, 0), 0.0, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "a2", 0, 0), 0.0, 0.0, of_double);
    assert_true(flicker_at(&run, "cycle_share", 0, 0) == 0.0);
    assert_true(flicker_at(&run, "unrest", 0, 0) == 0.0);
    neph_assert_close(flicker_at(&run, "p2p", 0, 0), (N - 1) * slope, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "mad", 0, 0), slope, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "std", 0, 0), slope * sqrt((N * N - 1) / 12.0), 0.0,
                      of_double);
    extraction_end(&run);
    run = flicker_run(&reference, &test, NULL,
                      (const char *const[]){"trend=keep", "noise_floor=keep", NULL});
    neph_assert_close(flicker_at(&run, "a4", 0, 0), sqrt(2.0) * slope, 0.0, of_double);
    neph_assert_close(flicker_at(&run, "a2", 0, 0), 0.5 * slope, 0.0, of_double);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* A static signal is exactly 0, also at an exposure and far beyond white; and so is a test that
 * equals the reference. */
static void test_nothing_is_exactly_nothing(void **state)
{
    enum { W = 19, H = 3, N = 24 };
    static const char *const names[] = {"std",      "p2p",      "mad",         "a4",     "a2",
                                        "block_a4", "block_a2", "cycle_share", "cyclic", "unrest"};
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = 0.7;
    uint64_t random = 3;
    for (int moving = 0; moving < 2; moving++) {
        struct sequence test = sequence_create(W, H, N);
        struct sequence reference = sequence_create(W, H, moving ? N : 1);
        for (size_t i = 0; i < (size_t)3 * W * H * (size_t)N; i++)
            test.samples[i] = moving || i < (size_t)3 * W * H
                                  ? (float)neph_test_uniform(&random, -0.5, 1.5)
                                  : test.samples[i - (size_t)3 * W * H];
        for (size_t i = 0; i < (size_t)3 * W * H * (size_t)reference.frame_count; i++)
            reference.samples[i] = moving ? test.samples[i] : 0.3f;
        struct extraction run = flicker_run(&reference, &test, &viewing, NULL);
        for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); k++) {
            double *map = flicker_map(&run, names[k]);
            for (int i = 0; i < W * H; i++)
                assert_true(map[i] == 0.0);
            free(map);
        }
        extraction_end(&run);
        sequence_destroy(&reference);
        sequence_destroy(&test);
    }
}

/* ---- the definitions, frame by frame --------------------------------------------------------- */

struct random_case {
    int width_px, height_px, frame_count;
    double exposure_ev, offset, spread; /* linear values: offset + spread * (-1 .. 1) */
    bool moving_reference;
    const char *const *assignments;
    bool detrend, subtract_noise;
};

static void fill_random(struct sequence *sequence, const struct random_case *given,
                        uint64_t *random)
{
    const size_t count = (size_t)3 * (size_t)sequence->width_px * (size_t)sequence->height_px *
                         (size_t)sequence->frame_count;
    for (size_t i = 0; i < count; i++)
        sequence->samples[i] = (float)(given->offset +
                                       given->spread * neph_test_uniform(random, -1.0, 1.0));
}

static void check_pixel(double *const *maps, int pixel, const struct flicker_truth *truth,
                        const struct random_case *given)
{
    neph_assert_close(maps[0][pixel], truth->std, 0.0, of_double);
    neph_assert_close(maps[1][pixel], truth->p2p, 0.0, of_double);
    neph_assert_close(maps[2][pixel], truth->mad, 0.0, of_double);
    /* Where almost nothing remains above the noise the root magnifies rounding: compare squares. */
    const double noise4 = given->subtract_noise ? 0.0 : truth->quarter_noise;
    const double noise2 = given->subtract_noise ? 0.0 : truth->half_noise;
    const double a4_squared = truth->a4_squared + noise4, a2_squared = truth->a2_squared + noise2;
    neph_assert_close(maps[3][pixel] * maps[3][pixel], fmax(0.0, a4_squared), 0.0, of_double);
    neph_assert_close(maps[4][pixel] * maps[4][pixel], fmax(0.0, a2_squared), 0.0, of_double);
    const double cycle = 0.5 * fmax(0.0, a4_squared) + fmax(0.0, a2_squared);
    neph_assert_close(maps[5][pixel], fmin(1.0, cycle / truth->variance), 0.0,
                      4.0 * of_double / truth->variance);
}

static void check_against_truth(const struct random_case *given, uint64_t seed)
{
    static const char *const names[] = {"std", "p2p", "mad", "a4", "a2", "cycle_share"};
    const int used = given->frame_count / 4 * 4;
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = given->exposure_ev;
    struct sequence test = sequence_create(given->width_px, given->height_px, given->frame_count);
    struct sequence reference = sequence_create(given->width_px, given->height_px,
                                                given->moving_reference ? given->frame_count : 1);
    fill_random(&test, given, &seed);
    fill_random(&reference, given, &seed);
    struct extraction run = flicker_run(&reference, &test, &viewing, given->assignments);
    double *maps[6];
    for (int k = 0; k < 6; k++)
        maps[k] = flicker_map(&run, names[k]);
    double *reference_std = flicker_map(&run, "reference_std");
    double *reference_a4 = flicker_map(&run, "reference_a4");
    long double *d = calloc((size_t)used, sizeof(*d)), *r = calloc((size_t)used, sizeof(*r));
    for (int y = 0; y < given->height_px; y++) {
        for (int x = 0; x < given->width_px; x++) {
            const int pixel = y * given->width_px + x;
            for (int t = 0; t < used; t++) {
                r[t] = luma_of(&reference, t % reference.frame_count, x, y, given->exposure_ev);
                d[t] = luma_of(&test, t, x, y, given->exposure_ev) - r[t];
            }
            const struct flicker_truth truth = truth_of(d, used, given->detrend);
            check_pixel(maps, pixel, &truth, given);
            const struct flicker_truth own = truth_of(r, used, given->detrend);
            neph_assert_close(reference_std[pixel], own.std, 0.0, of_double);
            if (given->subtract_noise)
                neph_assert_close(reference_a4[pixel] * reference_a4[pixel],
                                  fmax(0.0, own.a4_squared), 0.0, of_double);
        }
    }
    free(d);
    free(r);
    free(reference_std);
    free(reference_a4);
    for (int k = 0; k < 6; k++)
        free(maps[k]);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void test_streaming_is_the_definition(void **state)
{
    const struct random_case cases[] = {
        {1, 1, 16, 0.0, 0.5, 0.4, false, NULL, true, true},
        {17, 3, 16, 0.0, 0.5, 0.6, false, NULL, true, true},
        {16, 2, 20, 0.0, 0.2, 0.2, true, NULL, true, true},
        {33, 5, 31, -1.0, 1.0, 1.0, true, NULL, true, true}, /* 28 frames count */
        {5, 7, 64, 3.0, 0.06, 0.06, false, NULL, true, true},
        {3, 2, 200, 0.0, 0.5, 0.5, true, NULL, true, true},
        {5, 3, 40, 0.0, 0.5, 0.5, false,
         (const char *const[]){"trend=keep", "noise_floor=keep", NULL}, false, false},
        {5, 3, 40, 0.0, 0.5, 0.5, true, (const char *const[]){"noise_floor=keep", NULL}, true,
         false},
        {5, 3, 24, 0.0, 0.5, 0.5, false, (const char *const[]){"trend=keep", NULL}, false, true},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        check_against_truth(&cases[i], 100 + i);
}

/* A millionth of white, near white: nothing of it may cancel. Steps of 2^-20 below 1 are exact. */
static void test_small_flicker_on_a_large_value(void **state)
{
    enum { N = 64 };
    struct sequence reference = sequence_create(1, 1, 1), test = sequence_create(1, 1, N);
    long double d[N];
    for (int t = 0; t < N; t++) {
        const double value = 1.0 - (t % 4 == 0 ? 3.0 : t % 4 == 1 ? 2.0 : 1.0) * 0x1p-20;
        sequence_set(&test, t, 0, 0, value, value, value);
        d[t] = luma_of(&test, t, 0, 0, 0.0);
    }
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    const struct flicker_truth truth = truth_of(d, N, true);
    const double a4 = sqrt(truth.a4_squared), a2 = sqrt(truth.a2_squared);
    assert_true(a4 > 1e-7 && a4 < 1e-6);
    /* 2e-15 of a luma of 1 is 4e-9 of this amplitude. */
    neph_assert_close(flicker_at(&run, "a4", 0, 0), a4, 1e-8, 0.0);
    neph_assert_close(flicker_at(&run, "std", 0, 0), truth.std, 1e-8, 0.0);
    neph_assert_close(flicker_at(&run, "cycle_share", 0, 0),
                      (0.5 * a4 * a4 + a2 * a2) / truth.variance, 1e-6, 0.0);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* The same memory with different content is a different frame. */
static void test_reference_is_compared_by_value(void **state)
{
    enum { N = 16 };
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct sequence test = sequence_create(2, 1, N), memory = sequence_create(2, 1, 1);
    for (int t = 0; t < N; t++)
        for (int x = 0; x < 2; x++)
            sequence_set_luma(&test, t, x, 0, 0.5);
    struct neph_frame_pair pair = flicker_pair(&memory, &test, 0, &viewing);
    struct extraction run = extraction_begin(&neph_extractor_flicker, &pair, NULL);
    for (int t = 0; t < N; t++) {
        sequence_set_luma(&memory, 0, 1, 0, t % 2 && t > 4 ? 0.6 : 0.5);
        pair = flicker_pair(&memory, &test, t, &viewing);
        extraction_frame(&run, &pair);
    }
    extraction_flush(&run);
    assert_true(flicker_at(&run, "reference_std", 0, 0) == 0.0);
    neph_assert_close(flicker_at(&run, "p2p", 1, 0), 0.1, 1e-6, 0.0);
    neph_assert_close(flicker_at(&run, "reference_std", 1, 0), flicker_at(&run, "std", 1, 0), 1e-12,
                      0.0);
    extraction_end(&run);
    sequence_destroy(&memory);
    sequence_destroy(&test);
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* A dither that rotates through the 2x2 is present in pixels and absent in blocks; partial blocks
 * at odd borders keep their remaining flicker. */
static void test_blocks(void **state)
{
    enum { W = 5, H = 3, N = 16 };
    static const int turn[4] = {0, 1, 3, 2}; /* phase: position in the clockwise order */
    const double height = 0.1;
    struct sequence reference = still(W, H, 0.4), test = sequence_create(W, H, N);
    for (int t = 0; t < N; t++)
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                sequence_set_luma(&test, t, x, y,
                                  0.4 + (t % 4 == turn[(x & 1) + 2 * (y & 1)] ? height : 0.0));
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    double *a4 = flicker_map(&run, "a4"), *block = flicker_map(&run, "block_a4");
    double *block2 = flicker_map(&run, "block_a2");
    for (int y = 0; y < H; y++) {
        for (int x = 0; x < W; x++) {
            /* Right: two pixels a quarter period apart, alternately 1 and 1 of 2: their parts add
             * as perpendicular vectors. Below: the same. Corner: one pixel. */
            const bool right = x == W - 1, below = y == H - 1;
            const double expected = right && below   ? height / 2.0
                                    : right || below ? height / 2.0 / sqrt(2.0)
                                                     : 0.0;
            neph_assert_close(a4[y * W + x], height / 2.0, 1e-6, 0.0);
            neph_assert_close(block[y * W + x], expected, 1e-6, 2.0 * of_float);
            neph_assert_close(block2[y * W + x], right && below ? height / 4.0 : 0.0, 1e-6,
                              2.0 * of_float);
        }
    }
    free(a4);
    free(block);
    free(block2);
    extraction_end(&run);
    /* With slots of 2 px the first block is 4 px wide and has 3 rows: 12 pixels; the lowest row is
     * not balanced. */
    run = flicker_run(&reference, &test, NULL, (const char *const[]){"slot_px=2", NULL});
    neph_assert_close(flicker_at(&run, "block_a4", 0, 0), height * sqrt(2.0) / 12.0, 1e-6, 0.0);
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* Sums of one pixel of a signal, without images. */
static struct neph_flicker_spectrum spectrum_of(const double *v, int n,
                                                const struct neph_flicker_window *window)
{
    struct neph_flicker_sums sums = {0};
    struct neph_arena memory = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_flicker_sums_begin(&sums, 1, 1, NEPH_FLICKER_SUM_COUNT, &memory, &diag),
                   &diag);
    double rows[4][NEPH_FLICKER_LANES] = {0};
    const double *const frames[4] = {rows[0], rows[1], rows[2], rows[3]};
    for (int t = 0; t < n; t += 4) {
        const struct neph_flicker_weights weights = neph_flicker_weights_of(t, n);
        for (int k = 0; k < 4; k++)
            rows[k][0] = v[t + k];
        neph_flicker_sums_add(&sums, 0, 1, &weights, frames);
    }
    double values[NEPH_FLICKER_SUM_COUNT];
    neph_flicker_sums_of(&sums, 0, 0, values);
    neph_arena_finish(&memory);
    return neph_flicker_spectrum_of(window, values);
}

/* White noise of standard deviation s: a4^2 and its floor have the mean 4 s^2 / N, a2^2 and its
 * floor s^2 / N. The first is chi-square with 2 degrees of freedom per pixel, the floor with 8,
 * a2^2 with 1 and its floor with 4: relative standard errors over m pixels of sqrt(2 / (dof m)),
 * five of which are allowed. Detrending removes a fraction of about 1 / N, less in bins far from
 * these. The two probabilities are uniform: the share below p is binomial. */
static void test_white_noise(void **state)
{
    enum { M = 20000, N = 32 };
    const double s = 0.05, p = 0.02;
    uint64_t random = 20261121;
    for (int detrend = 0; detrend < 2; detrend++) {
        const struct neph_flicker_window window = neph_flicker_window_of(N, detrend, true);
        double quarter = 0.0, half = 0.0, quarter_noise = 0.0, half_noise = 0.0;
        int quarter_found = 0, half_found = 0;
        for (int i = 0; i < M; i++) {
            double v[N];
            for (int t = 0; t < N; t++)
                v[t] = s * normal(&random);
            const struct neph_flicker_spectrum spectrum = spectrum_of(v, N, &window);
            quarter += spectrum.a4 * spectrum.a4 / M;
            half += spectrum.a2 * spectrum.a2 / M;
            quarter_noise += spectrum.quarter_noise / M;
            half_noise += spectrum.half_noise / M;
            quarter_found += neph_flicker_quarter_p(&spectrum) < p;
            half_found += neph_flicker_half_p(&spectrum) < p;
        }
        const double trend = detrend ? 1.0 / N : 0.0;
        neph_assert_close(quarter, 4.0 * s * s / N, 5.0 * sqrt(2.0 / (2.0 * M)) + trend, 0.0);
        neph_assert_close(quarter_noise, 4.0 * s * s / N, 5.0 * sqrt(2.0 / (8.0 * M)) + trend, 0.0);
        neph_assert_close(half, s * s / N, 5.0 * sqrt(2.0 / (1.0 * M)) + trend, 0.0);
        neph_assert_close(half_noise, s * s / N, 5.0 * sqrt(2.0 / (4.0 * M)) + trend, 0.0);
        const double allowed = 5.0 * sqrt(p * (1.0 - p) / M) + trend * p;
        neph_assert_close((double)quarter_found / M, p, 0.0, allowed);
        neph_assert_close((double)half_found / M, p, 0.0, allowed);
    }
}

/* F(2, 8) and F(1, 4) at tabulated points (NIST/SEMATECH e-Handbook, 1.3.6.7.3): upper 5 % and 1 %
 * critical values, which the tables give to three decimals. */
static void test_significance_of_a_cycle(void **state)
{
    const double table[][3] = {{4.459, 7.709, 0.05}, {8.649, 21.198, 0.01}};
    for (int i = 0; i < 2; i++) {
        const struct neph_flicker_spectrum quarter = {.quarter_cos = sqrt(table[i][0]),
                                                      .quarter_noise = 1.0};
        const struct neph_flicker_spectrum half = {.half = sqrt(table[i][1]), .half_noise = 1.0};
        neph_assert_close(neph_flicker_quarter_p(&quarter), table[i][2], 3e-4, 0.0);
        neph_assert_close(neph_flicker_half_p(&half), table[i][2], 3e-4, 0.0);
    }
    const struct neph_flicker_spectrum none = {0}, pure = {.quarter_sin = 0.1, .half = 0.1};
    assert_true(neph_flicker_quarter_p(&none) == 1.0 && neph_flicker_half_p(&none) == 1.0);
    assert_true(neph_flicker_quarter_p(&pure) == 0.0 && neph_flicker_half_p(&pure) == 0.0);
    /* Deep in the tail of t with 4 degrees of freedom: 12 / f^2 of F = f (its leading term). */
    const struct neph_flicker_spectrum deep = {.half = 1e4, .half_noise = 1.0};
    neph_assert_close(neph_flicker_half_p(&deep), 6.0 / 1e16, 1e-7, 0.0);
}

/* A line added to a signal changes nothing: in the dark, where lines are exact. */
static void test_a_trend_changes_nothing(void **state)
{
    enum { W = 8, N = 48 };
    uint64_t random = 5;
    struct sequence reference = sequence_create(W, 1, 1);
    struct sequence level = sequence_create(W, 1, N), rising = sequence_create(W, 1, N);
    for (int t = 0; t < N; t++) {
        for (int x = 0; x < W; x++) {
            const double steps = 8.0 + floor(neph_test_uniform(&random, 0.0, 8.0));
            const double flat = steps * 0x1p-16, sloped = (steps + t * (x - 1)) * 0x1p-17;
            sequence_set(&level, t, x, 0, 0.5 * flat, 0.5 * flat, 0.5 * flat);
            sequence_set(&rising, t, x, 0, sloped, sloped, sloped);
        }
    }
    struct extraction one = flicker_run(&reference, &level, NULL, NULL);
    struct extraction other = flicker_run(&reference, &rising, NULL, NULL);
    static const char *const names[] = {"a4", "a2", "cycle_share"};
    for (size_t k = 0; k < sizeof(names) / sizeof(names[0]); k++) {
        double *a = flicker_map(&one, names[k]), *b = flicker_map(&other, names[k]);
        for (int x = 1; x < W; x++)
            neph_assert_close(b[x], a[x], 1e-9, 1e-12);
        free(a);
        free(b);
    }
    extraction_end(&one);
    extraction_end(&other);
    sequence_destroy(&reference);
    sequence_destroy(&level);
    sequence_destroy(&rising);
}

/* ---- counted frames -------------------------------------------------------------------------- */

static void test_only_whole_cycles_after_the_warm_up(void **state)
{
    enum { N = 27, WARM_UP = 6 }; /* 21 remain, 20 count */
    uint64_t random = 8;
    struct sequence reference = still(3, 2, 0.5), all = sequence_create(3, 2, N);
    struct sequence used = sequence_create(3, 2, 20);
    for (size_t i = 0; i < (size_t)3 * 3 * 2 * N; i++)
        all.samples[i] = (float)neph_test_uniform(&random, 0.0, 1.0);
    memcpy(used.samples, sequence_plane(&all, WARM_UP, 0), (size_t)3 * 3 * 2 * 20 * sizeof(float));
    struct extraction one = flicker_run(&reference, &all, NULL,
                                        (const char *const[]){"warm_up=6", "first_slot=1", NULL});
    struct extraction other = flicker_run(&reference, &used, NULL,
                                          (const char *const[]){"first_slot=3", NULL});
    neph_assert_close(extraction_scalar(&one, "flicker_frames"), 20.0, 0.0, 0.0);
    for (int map = 0; map < neph_extractor_flicker.map_count; map++) {
        double *a = extraction_map(&one, map), *b = extraction_map(&other, map);
        assert_memory_equal(a, b, 6 * sizeof(*a));
        free(a);
        free(b);
    }
    extraction_end(&one);
    extraction_end(&other);
    sequence_destroy(&reference);
    sequence_destroy(&all);
    sequence_destroy(&used);
}

static void test_too_short(void **state)
{
    const struct neph_extractor *extractor = &neph_extractor_flicker;
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct neph_settings settings = neph_options_default(extractor->options);
    struct sequence one = sequence_create(1, 1, 1);
    struct neph_frame_pair pair = flicker_pair(&one, &one, 0, &viewing);
    const int counts[] = {16, 15, 19, 0};
    const bool enough[] = {true, false, true, false};
    for (int i = 0; i < 4; i++) {
        pair.frame_count = counts[i];
        assert_int_equal(extractor->obstacle(&pair, &settings) == NULL, enough[i]);
    }
    struct neph_diag diag = {0};
    neph_assert_ok(neph_options_set(extractor->options, "flicker", "warm_up=4", &settings, &diag),
                   &diag);
    pair.frame_count = 19;
    assert_non_null(extractor->obstacle(&pair, &settings));
    sequence_destroy(&one);
}

static void test_ended_early(void **state)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    struct sequence test = sequence_create(2, 2, 32);
    struct neph_frame_pair pair = flicker_pair(&test, &test, 0, &viewing);
    struct extraction run = extraction_begin(&neph_extractor_flicker, &pair, NULL);
    for (int t = 0; t < 31; t++) {
        pair = flicker_pair(&test, &test, t, &viewing);
        extraction_frame(&run, &pair);
    }
    extraction_flush(&run);
    for (int map = 0; map < neph_extractor_flicker.map_count; map++) {
        double *values = extraction_map(&run, map);
        for (int i = 0; i < 4; i++)
            assert_true(isnan(values[i]));
        free(values);
    }
    double value = 0.0;
    assert_non_null(neph_extractor_flicker.scalar(run.state, 0, &value));
    extraction_end(&run);
    sequence_destroy(&test);
}

/* ---- phases and ages ------------------------------------------------------------------------- */

static void test_slots_are_traced_in_turn(void **state)
{
    static const int xy[3][4][2] = {
        [NEPH_SLOT_CLOCKWISE] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
        [NEPH_SLOT_Z] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}},
        [NEPH_SLOT_DIAGONAL] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}},
    };
    for (int order = 0; order < 3; order++) {
        for (int t = 0; t < 4; t++) {
            struct neph_phase_age scheme = {.order = (enum neph_slot_order)order, .slot_px = 1};
            const int x = xy[order][t][0], y = xy[order][t][1];
            assert_int_equal(neph_phase_of(&scheme, x, y), x + 2 * y);
            for (int age = 0; age < 4; age++)
                assert_int_equal(neph_frame_of_age(&scheme, x + 6, y + 2, age), (t + age) % 4);
            scheme.first_slot = 3; /* frame 0 traces the last slot, frame 1 the first */
            assert_int_equal(neph_frame_of_age(&scheme, x, y, 0), (t + 1) % 4);
            scheme = (struct neph_phase_age){(enum neph_slot_order)order, 0, 3, true};
            assert_int_equal(neph_frame_of_age(&scheme, 3 * x + 2, 3 * y + 1, 0), (t + 3) % 4);
            assert_int_equal(neph_frame_of_age(&scheme, 3 * x + 8, 3 * y + 1, 0), t);
        }
    }
}

/* A planted table of means by phase and age is recovered, and so are its ages and its slope. */
static void test_phase_age_table(void **state)
{
    enum { W = 7, H = 5, N = 24 };
    static const int turn[4] = {0, 1, 3, 2};
    struct sequence reference = still(W, H, 0.5), test = sequence_create(W, H, N);
    for (int t = 0; t < N; t++) {
        for (int y = 0; y < H; y++) {
            for (int x = 0; x < W; x++) {
                const int phase = (x & 1) + 2 * (y & 1), age = (t - turn[phase] + 4) % 4;
                sequence_set_luma(&test, t, x, y, 0.5 + 0.02 * phase - 0.01 * age);
            }
        }
    }
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    for (int phase = 0; phase < 4; phase++) {
        for (int age = 0; age < 4; age++) {
            char name[32];
            snprintf(name, sizeof(name), "phase_age_%d_%d", phase, age);
            neph_assert_close(extraction_scalar(&run, name), 0.02 * phase - 0.01 * age, 0.0,
                              2.0 * of_float);
            snprintf(name, sizeof(name), "age_%d", age);
            neph_assert_close(flicker_at(&run, name, phase & 1, phase >> 1),
                              0.02 * phase - 0.01 * age, 0.0, 2.0 * of_float);
        }
        neph_assert_close(flicker_at(&run, "age_slope", phase & 1, phase >> 1), -0.01, 0.0,
                          2.0 * of_float);
    }
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void test_a_phase_that_is_not_there(void **state)
{
    struct sequence reference = still(1, 2, 0.5), test = sequence_create(1, 2, 16);
    struct extraction run = flicker_run(&reference, &test, NULL, NULL);
    double value = NAN;
    assert_null(neph_extractor_flicker.scalar(run.state, 4 * 2, &value));
    assert_true(isfinite(value));
    assert_non_null(neph_extractor_flicker.scalar(run.state, 4 * 1, &value));
    assert_non_null(neph_extractor_flicker.scalar(run.state, 4 * 3 + 1, &value));
    extraction_end(&run);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

/* ---- conventions ----------------------------------------------------------------------------- */

static void allow_processors(const cpu_set_t *allowed)
{
    assert_int_equal(sched_setaffinity(0, sizeof(*allowed), allowed), 0);
}

static void test_bits_do_not_depend_on_threads(void **state)
{
    enum { W = 50, H = 37, N = 20 };
    uint64_t random = 77;
    struct sequence test = sequence_create(W, H, N), reference = sequence_create(W, H, N);
    for (size_t i = 0; i < (size_t)3 * W * H * N; i++) {
        test.samples[i] = (float)neph_test_uniform(&random, 0.0, 1.2);
        reference.samples[i] = (float)neph_test_uniform(&random, 0.0, 1.2);
    }
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof(all), &all), 0);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &all))
            CPU_SET(cpu, &one);
    struct extraction many = flicker_run(&reference, &test, NULL, NULL);
    allow_processors(&one);
    struct extraction single = flicker_run(&reference, &test, NULL, NULL);
    allow_processors(&all);
    for (int map = 0; map < neph_extractor_flicker.map_count; map++) {
        double *a = extraction_map(&many, map), *b = extraction_map(&single, map);
        assert_memory_equal(a, b, (size_t)W * H * sizeof(*a));
        free(a);
        free(b);
    }
    extraction_end(&many);
    extraction_end(&single);
    sequence_destroy(&reference);
    sequence_destroy(&test);
}

static void test_table(void **state)
{
    extraction_check_table(&neph_extractor_flicker);
    assert_ptr_equal(neph_extractor_find("flicker"), &neph_extractor_flicker);
    for (const struct neph_metric *m = neph_extractor_flicker.metrics; m->name; m++) {
        const struct neph_extractor *owner = NULL;
        assert_ptr_equal(neph_metric_find(m->name, &owner), m); /* the name is unique */
        assert_ptr_equal(owner, &neph_extractor_flicker);
    }
}

#include "tests/main.h"

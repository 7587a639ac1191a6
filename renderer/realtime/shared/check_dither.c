/* SPDX-License-Identifier: MIT
 *
 * Tests of dithers against their published formulas, computed by other means: interleaved gradient
 * noise in double, the hash in Python's integers. Then the shader against C, bit by bit.
 */
#include "tests/renderer/realtime_test.h"

#include "base/sort.h"
#include "renderer/blue_noise.h"
#include "renderer/realtime/shared/check_reference_dither.h"

enum { KINDS = RT_DITHER_SLICE + 1, CHANNELS = 4 };

/* Random ranks below 4096, for tests that do not depend on the masks. */
static void fill_ranks(uint32_t ranks[NEPH_RT_NOISE_COUNT], uint64_t seed)
{
    for (size_t i = 0; i < NEPH_RT_NOISE_COUNT; i++)
        ranks[i] = (uint32_t)(neph_test_random(&seed) % 4096);
}

static double distance_round_the_circle(double a, double b)
{
    return fabs(a - b - round(a - b));
}

/* ---- interleaved ----------------------------------------------------------------------------- */

static double interleaved(int x_px, int y_px, uint32_t frame)
{
    return (double)cpu_dither(&(struct cpu_dither){0}, RT_DITHER_INTERLEAVED, x_px, y_px, frame, 0);
}

/* Error of steps of 2^-32, and of the last 8 bits, which the value omits. */
static double interleaved_error(int x_px, int y_px)
{
    return 53.0 * (abs(x_px) + abs(y_px) + 64) * 0x1p-33 + 0x1p-24;
}

static void test_interleaved_gradient_values(void **state)
{
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
    for (size_t i = 0; i < COUNT(known); i++)
        neph_assert_close(interleaved(known[i].x, known[i].y, known[i].frame), known[i].value, 0.0,
                          interleaved_error(known[i].x, known[i].y));
}

static double fraction(double value)
{
    return value - floor(value);
}

/* The published formula with the channel's own advance. A double's error is below 1e-10. */
static double published(int x_px, int y_px, uint32_t frame, uint32_t channel, double *inner)
{
    static const double shifts_px[CHANNELS] = {5.588238, 5.622808, 5.540572, 5.600479};
    const int first = channel & 1 ? y_px : x_px, second = channel & 1 ? x_px : y_px;
    const double shift_px = shifts_px[channel] * (frame % 64);
    *inner = fraction(0.06711056 * (channel & 2 ? -first : first) + 0.00583715 * second +
                      (0.06711056 + 0.00583715) * shift_px);
    return fraction(52.9829189 * *inner);
}

/* At sizes of frames. The formula jumps by 0.983 where its inner fraction wraps from 1 to 0: there
 * rounding may fall to either side, and such pixels are left out. */
static void test_interleaved_is_the_published_formula(void **state)
{
    uint64_t seed = 20261125;
    int left_out = 0;
    enum { COUNT = 400000 };
    for (int i = 0; i < COUNT; i++) {
        const int x = (int)(neph_test_random(&seed) % 8192) - 256;
        const int y = (int)(neph_test_random(&seed) % 8192) - 256;
        const uint32_t frame = (uint32_t)(neph_test_random(&seed) % 1000),
                       channel = (uint32_t)i % 4;
        const struct cpu_dither dither = {0};
        double inner;
        const double expected = published(x, y, frame, channel, &inner);
        const double value = (double)cpu_dither(&dither, RT_DITHER_INTERLEAVED, x, y, frame,
                                                channel);
        const double error = interleaved_error(x, y);
        if (distance_round_the_circle(inner, 0.0) < error / 53.0)
            left_out++;
        else if (!(distance_round_the_circle(value, expected) <= error))
            fail_msg("pixel %d %d, frame %u, channel %u: %.9f, expected %.9f", x, y, frame, channel,
                     value, expected);
    }
    assert_true(left_out < COUNT / 10000); /* expected: 4 in a million */
}

/* The property that Jimenez designed it for: the nine values of any 3x3 window are spread over the
 * unit interval, taken as a circle, with gaps near 1/9. With his constants the widest is 0.135018
 * (rational arithmetic; here rounded to 2^-19); for nine values of white noise the widest has mean
 * (1 + 1/2 + ... + 1/9) / 9 = 0.31. */
static void test_interleaved_windows_cover_the_circle(void **state)
{
    for (int i = 0; i < 100 * 100; i++) {
        double values[10], widest = 0.0;
        for (int k = 0; k < 9; k++)
            values[k] = interleaved(i % 100 + k % 3, i / 100 + k / 3, 5);
        neph_sort_doubles(values, 9);
        values[9] = values[0] + 1.0;
        for (int k = 0; k < 9; k++)
            widest = fmax(widest, values[k + 1] - values[k]);
        assert_true(widest < 0.13503);
    }
}

/* ---- white ----------------------------------------------------------------------------------- */

static void test_white_values(void **state)
{
    static const struct {
        int x, y;
        uint32_t frame, seed, word;
    } known[] = {
        {0, 0, 0, 0, 0x0f02f829u},
        {1, 2, 3, 4, 0x3622cd16u},
        {-1, 0, 0, 0, 0x0394ccb3u},
        {1919, 1079, 100, 7, 0x8954e262u},
    };
    for (size_t i = 0; i < COUNT(known); i++) {
        const struct cpu_dither dither = {.seed = known[i].seed};
        const double value = (double)cpu_dither(&dither, RT_DITHER_WHITE, known[i].x, known[i].y,
                                                known[i].frame, 0);
        assert_true(value == ((known[i].word >> 9) + 0.5) / 8388608.0);
    }
}

/* Moments of 2^16 values and of the products of two, neighbours in all three directions and
 * channels, within 5 standard deviations: sd(mean) = sqrt(1/12 / n), sd(mean square) = sqrt(1/180 /
 * n), sd(product) = 1/12 / sqrt(n). */
static void test_white_is_white(void **state)
{
    static const struct {
        int x, y;
        uint32_t frame, channel;
    } others[] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0},
                  {0, 0, 0, 1}, {0, 0, 0, 2}, {0, 0, 0, 3}};
    enum { COUNT = 1 << 16, OTHERS = COUNT(others) };
    const struct cpu_dither dither = {.seed = 3};
    double mean = 0.0, square = 0.0, products[OTHERS] = {0.0};
    for (int i = 0; i < COUNT; i++) {
        const int x = i % 64 - 32, y = i / 64 % 64 - 32;
        const uint32_t frame = (uint32_t)(i / 4096);
        const double value = (double)cpu_dither(&dither, RT_DITHER_WHITE, x, y, frame, 0) - 0.5;
        mean += value / COUNT;
        square += value * value / COUNT;
        for (size_t k = 0; k < OTHERS; k++)
            products[k] += value / COUNT *
                           ((double)cpu_dither(&dither, RT_DITHER_WHITE, x + others[k].x,
                                               y + others[k].y, frame + others[k].frame,
                                               others[k].channel) -
                            0.5);
    }
    neph_assert_close(mean, 0.0, 0.0, 5 * sqrt(1 / 12.0 / COUNT));
    neph_assert_close(square, 1 / 12.0, 0.0, 5 * sqrt(1 / 180.0 / COUNT));
    for (size_t k = 0; k < OTHERS; k++)
        neph_assert_close(products[k], 0.0, 0.0, 5 / 12.0 / sqrt(COUNT));
}

/* ---- blue ------------------------------------------------------------------------------------ */

/* Each channel advances by its own irrational in steps of 2^-32, also where the frame times the
 * step exceeds 2^32; frame 0 of channel 0 is the mask itself. */
static void test_blue_goes_on_by_irrationals(void **state)
{
    static const uint32_t steps[CHANNELS] = {2654435769u, 3144134277u, 1779033703u, 2773480763u};
    const double irrationals[CHANNELS] = {0.5 * (sqrt(5.0) - 1.0), sqrt(3.0), sqrt(2.0), sqrt(7.0)};
    const uint32_t frames[] = {0, 1, 2, 3, 1000, UINT32_MAX};
    static uint32_t ranks[NEPH_RT_NOISE_COUNT];
    fill_ranks(ranks, 5);
    const struct cpu_dither dither = {.noise_ranks = ranks};
    for (int c = 0; c < CHANNELS; c++) {
        assert_true(steps[c] % 2 == 1); /* 2^32 frames without repetition */
        assert_true(distance_round_the_circle(steps[c] * 0x1p-32, irrationals[c]) < 0x1p-32);
        for (size_t i = 0; i < COUNT(frames); i++)
            for (int y = 0; y < 64; y++)
                for (int x = 0; x < 64; x++) {
                    const size_t place = (size_t)(64 * ((y + 37 * c) % 64) + (x + 47 * c) % 64);
                    const uint32_t word = (2u * ranks[place] + 1u) * (1u << 19) +
                                          frames[i] * steps[c];
                    const float value = cpu_dither(&dither, RT_DITHER_BLUE, x, y - 64, frames[i],
                                                   (uint32_t)c);
                    assert_true((double)value == (word >> 8) * 0x1p-24);
                }
    }
}

static void test_spatiotemporal_is_the_full_mask(void **state)
{
    static uint32_t ranks[NEPH_RT_NOISE_COUNT];
    fill_ranks(ranks, 6);
    const struct cpu_dither dither = {.noise_ranks = ranks};
    for (int i = 0; i < 64 * 64 * 32; i++) {
        const float value = cpu_dither(&dither, RT_DITHER_SPATIOTEMPORAL, i % 64 - 64,
                                       i / 64 % 64 + 64, (uint32_t)(i / 4096) + 32, 0);
        assert_true((double)value == (ranks[4096 + i] + 0.5) / 4096.0);
    }
}

/* ---- all ------------------------------------------------------------------------------------- */

/* For any pixel and any frame. */
static void test_values_stay_within_the_unit_interval(void **state)
{
    static uint32_t ranks[NEPH_RT_NOISE_COUNT];
    uint64_t seed = 17;
    fill_ranks(ranks, seed);
    const struct cpu_dither dither = {1, ranks};
    for (int kind = 0; kind < KINDS; kind++)
        for (int i = 0; i < 20000; i++) {
            const uint64_t word = neph_test_random(&seed), more = neph_test_random(&seed);
            const float value = cpu_dither(&dither, kind, (int)(uint32_t)word, (int)(word >> 32),
                                           (uint32_t)more, (uint32_t)(more >> 32));
            assert_true(value >= 0.0f && value < 1.0f);
            assert_true(kind != RT_DITHER_NONE || value == 0.5f);
        }
}

/* Number of cells, of 4x4 in the unit square, with pairs of 16 frames; mean over all pixels. */
static double count_pair_cells(const struct cpu_dither *dither, int kind, bool is_mirrored,
                               uint32_t channel, int *most)
{
    double mean = 0.0;
    *most = 0;
    for (int pixel = 0; pixel < 4096; pixel++) {
        const int x = pixel % 64, y = pixel / 64;
        uint32_t met = 0;
        for (uint32_t frame = 0; frame < 16; frame++) {
            const float a = cpu_dither(dither, kind, x, y, frame, 0);
            const float b = is_mirrored ? cpu_dither(dither, kind, y, x, frame, 0)
                                        : cpu_dither(dither, kind, x, y, frame, channel);
            met |= 1u << ((int)(4.0f * a) + 4 * (int)(4.0f * b));
        }
        const int count = __builtin_popcount(met);
        *most = count > *most ? count : *most;
        mean += count / 4096.0;
    }
    return mean;
}

/* With the mirrored pixel's number as the second one, 16 pairs of a pixel lie on a line along the
 * diagonal, which crosses at most 8 of 16 cells. Two channels do not: 16 random pairs reach
 * 16 (1 - (15/16)^16) = 10.3 cells; the least of the kinds is 9.5. */
static void test_channels_cover_the_square(void **state)
{
    static uint32_t ranks[NEPH_RT_NOISE_COUNT];
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_blue_noise_load(NEPH_SOURCE_DIR "/renderer/blue_noise.png", 1, ranks, &diag), &diag);
    const struct cpu_dither dither = {1, ranks};
    int most;
    assert_true(count_pair_cells(&dither, RT_DITHER_BLUE, true, 0, &most) < 8.0);
    assert_true(most <= 8);
    for (int kind = RT_DITHER_WHITE; kind < KINDS; kind++)
        for (uint32_t channel = 1; channel < CHANNELS; channel++)
            if (!(count_pair_cells(&dither, kind, false, channel, &most) > 9.4))
                fail_msg("kind %d, channel %u", kind, channel);
}

static const uint32_t probe_code[] = {
#include "shaders/probe_dither.comp.inc"
};
static const struct neph_rt_pass probe = {
    .name = "probe",
    .shader = {"probe_dither", probe_code, sizeof(probe_code)},
    .resolution = RT_FULL,
    .writes = NEPH_RT_BIT(RT_COLOR),
};

/* The same bits on the device, so that the properties above are true for both. */
static void test_the_shader_is_the_same(void **state)
{
    static const uint32_t frames[] = {0, 1, 31, 63, 64, 1000003, UINT32_MAX};
    static const char *const kinds[KINDS] = {"none", "white",          "interleaved",
                                             "blue", "spatiotemporal", "slice"};
    const int size_px[2] = {141, 75}, origin_px[2] = {0, 0};
    for (int kind = 0; kind < KINDS; kind++) {
        char assignment[64];
        snprintf(assignment, sizeof(assignment), "ray_dither=%s", kinds[kind]);
        const struct neph_settings settings = test_settings(assignment);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, size_px, origin_px, 0x123456789u, &test);
        const struct cpu_dither dither = {test.view.seed, test.noise_ranks};
        for (size_t f = 0; f < COUNT(frames); f++) {
            test.view.frame = frames[f];
            for (int y = 0; y < size_px[1]; y++)
                for (int x = 0; x < size_px[0]; x++) {
                    float numbers[CHANNELS];
                    for (uint32_t channel = 0; channel < CHANNELS; channel++)
                        numbers[channel] = cpu_dither(&dither, kind, x - 70, y - 5, frames[f],
                                                      channel);
                    cpu_put_full(&test.cpu, RT_COLOR, x, y, numbers);
                }
            *test.device.view = test.view;
            neph_assert_ok(neph_rt_device_run(&test.device, &probe, NULL), NULL);
            test_same_words(&test, RT_COLOR, test.view.seed);
        }
    }
}

#include "tests/renderer/main.h"

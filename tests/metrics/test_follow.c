/* SPDX-License-Identifier: MIT
 *
 * Gain and phase lag under a sine of the light: filters with a response in closed form.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/extractors.h"

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT };

static const struct neph_viewing viewing = {60.0, 67.0, 0.0, 100.0};

/* The value of a pixel in a frame, of reference or test; frames before 0 are the past. */
typedef double picture_function(int frame, int pixel);

static struct neph_image *grey_image(picture_function *function, int frame)
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            planes[c][i] = (float)function(frame, i);
    return image;
}

static struct extraction run(picture_function *reference, picture_function *test, int frame_count,
                             const char *const *assignments)
{
    struct extraction extraction;
    for (int frame = 0; frame < frame_count; frame++) {
        struct neph_image *r = grey_image(reference, frame), *t = grey_image(test, frame);
        const struct neph_frame_pair pair = extraction_pair(r, NULL, t, "radiance", frame,
                                                            &viewing);
        if (frame == 0)
            extraction = extraction_begin(&neph_extractor_follow, &pair, assignments);
        extraction_frame(&extraction, &pair);
        neph_image_destroy(r);
        neph_image_destroy(t);
    }
    extraction_flush(&extraction);
    return extraction;
}

static const char *const three_periods[] = {"period_1=16", "period_2=32", "period_3=64", NULL};

/* The map of a metric's pool, at a pixel; NaN where the share of a map counts no value. */
static double value_at(const struct extraction *extraction, const char *metric, int pixel)
{
    for (const struct neph_metric *m = extraction->extractor->metrics; m->name; m++) {
        if (strcmp(m->name, metric) != 0)
            continue;
        double *values = extraction_map(extraction, m->map);
        const double value = values[pixel];
        free(values);
        return value;
    }
    fail_msg("no metric '%s'", metric);
    return NAN;
}

/* Over all pixels with a value; returns their count. */
static int count_where(const struct extraction *extraction, const char *metric, double wanted)
{
    int count = 0;
    for (const struct neph_metric *m = extraction->extractor->metrics; m->name; m++) {
        if (strcmp(m->name, metric) != 0)
            continue;
        double *values = extraction_map(extraction, m->map);
        for (int i = 0; i < PIXELS; i++)
            count += values[i] == wanted;
        free(values);
    }
    return count;
}

/* ---- images ---------------------------------------------------------------------------------- */

static const double periods[3] = {16.0, 32.0, 64.0};

/* Light that varies with three periods; its amplitude differs by pixel. */
static double light(double frame)
{
    double sum = 1.0;
    for (int k = 0; k < 3; k++)
        sum += 0.2 * sin(2.0 * M_PI * frame / periods[k] + k);
    return sum;
}

static double lit(int frame, int pixel)
{
    return 0.1 + 0.3 * (1.0 + pixel % WIDTH / (double)WIDTH) * light(frame);
}

/* An exponential average of a function with a long past; the weight of earlier frames is (1 -
 * 0.04)^500 = 1e-9. */
static double average(double function(double), double alpha, int frame)
{
    double value = function(frame - 500);
    for (int t = frame - 499; t <= frame; t++)
        value += alpha * (function(t) - value);
    return value;
}

static const double alphas[2] = {0.04, 0.1};

static double averaged(int frame, int pixel)
{
    static int known_frame = -1;
    static double known[2];
    for (int a = 0; a < 2 && frame != known_frame; a++)
        known[a] = average(light, alphas[a], frame);
    known_frame = frame;
    return 0.1 + 0.3 * (1.0 + pixel % WIDTH / (double)WIDTH) * known[pixel / WIDTH % 2];
}

static double late(int frame, int pixel)
{
    return 0.1 + 0.3 * (1.0 + pixel % WIDTH / (double)WIDTH) * light(frame - 3);
}

static double early(int frame, int pixel)
{
    return lit(frame + 2, pixel);
}

/* With a drift that increases to the right. */
static double drifting(int frame, int pixel)
{
    return lit(frame, pixel) + 0.002 * frame * (pixel % WIDTH) / (double)WIDTH;
}

static double drift_half_followed(int frame, int pixel)
{
    return 0.5 * lit(frame, pixel) + 0.003 * frame * (pixel % WIDTH) / (double)WIDTH;
}

static double still(int frame, int pixel)
{
    (void)frame;
    (void)pixel;
    return 0.4;
}

static double noise(int frame, int pixel, uint64_t seed)
{
    uint64_t z = seed * 0x9e3779b97f4a7c15u +
                 (uint64_t)(frame * PIXELS + pixel + 1) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)(z >> 11) * 0x1p-53 - 0.5;
}

static double noisy(int frame, int pixel)
{
    return 0.4 + 0.2 * noise(frame, pixel, 1);
}

static double lit_and_noisy(int frame, int pixel)
{
    return lit(frame, pixel) + 0.02 * noise(frame, pixel, 2);
}

static double dark(int frame, int pixel)
{
    return (pixel == 7 ? 0.1 : 1e-4) * (2.0 + sin(2.0 * M_PI * frame / 32.0));
}

/* ---- tests ----------------------------------------------------------------------------------- */

/* The closed form of follow.c. Images are floats: 3e-8 of a value, so better than 1e-6 here. */
static void test_exponential_average(void **state)
{
    static const int frame_counts[] = {128, 100, 256}; /* 100: no whole number of any period */
    for (int n = 0; n < 3; n++) {
        struct extraction extraction = run(lit, averaged, frame_counts[n], three_periods);
        for (int a = 0; a < 2; a++)
            for (int k = 0; k < 3; k++) {
                char metric[40];
                const double w = 2.0 * M_PI / periods[k], left = 1.0 - alphas[a];
                const double re = 1.0 - left * cos(w), im = left * sin(w);
                const int pixel = a * WIDTH + 11;
                snprintf(metric, sizeof(metric), "follow_gain_%d_p50", k + 1);
                neph_assert_close(value_at(&extraction, metric, pixel), alphas[a] / hypot(re, im),
                                  1e-6, 0.0);
                snprintf(metric, sizeof(metric), "follow_lag_%d_p50", k + 1);
                neph_assert_close(value_at(&extraction, metric, pixel), atan2(im, re) / w, 1e-6,
                                  0.0);
                snprintf(metric, sizeof(metric), "follow_share_%d", k + 1);
                assert_int_equal(count_where(&extraction, metric, 1.0), PIXELS);
                snprintf(metric, sizeof(metric), "follow_lost_share_%d", k + 1);
                assert_int_equal(count_where(&extraction, metric, 0.0), PIXELS);
            }
        extraction_end(&extraction);
    }
}

/* Values of the closed form, by hand: w = 2 pi / 32, a = 0.1: 1 - 0.9 cos w = 0.117294, 0.9 sin w =
 * 0.175581: gain 0.1 / 0.211155, lag 0.981850 / w. */
static void test_published_number(void **state)
{
    struct extraction extraction = run(lit, averaged, 128, three_periods);
    neph_assert_close(value_at(&extraction, "follow_gain_2_p50", WIDTH), 0.473586, 0.0, 2e-6);
    neph_assert_close(value_at(&extraction, "follow_lag_2_p50", WIDTH), 5.000543, 0.0, 1e-4);
    neph_assert_close(extraction_scalar(&extraction, "follow_period_2"), 32.0, 0.0, 0.0);
    extraction_end(&extraction);
}

static void test_delay(void **state)
{
    static const struct {
        picture_function *test;
        double lag, tolerance;
    } cases[] = {{late, 3.0, 1e-5}, {early, -2.0, 1e-5}, {lit, 0.0, 0.0}};
    for (int i = 0; i < 3; i++) {
        struct extraction extraction = run(lit, cases[i].test, 128, three_periods);
        for (int k = 0; k < 3; k++) {
            char metric[40];
            snprintf(metric, sizeof(metric), "follow_gain_%d_p50", k + 1);
            neph_assert_close(value_at(&extraction, metric, 17), 1.0, 0.0, cases[i].tolerance);
            snprintf(metric, sizeof(metric), "follow_lag_%d_p50", k + 1);
            neph_assert_close(value_at(&extraction, metric, 17), cases[i].lag, 0.0,
                              cases[i].tolerance);
        }
        extraction_end(&extraction);
    }
}

/* Drift is fitted together with the sines, however the test follows it. */
static void test_drift(void **state)
{
    struct extraction extraction = run(drifting, drift_half_followed, 90, three_periods);
    for (int pixel = 0; pixel < WIDTH; pixel += 13) {
        neph_assert_close(value_at(&extraction, "follow_gain_1_p50", pixel), 0.5, 0.0, 1e-5);
        neph_assert_close(value_at(&extraction, "follow_lag_3_p50", pixel), 0.0, 0.0, 1e-4);
    }
    extraction_end(&extraction);
}

/* White noise is no sine: 3600 draws at 1e-7 each. The sine under noise is found, and a static test
 * has gain 0 and no lag. */
static void test_noise(void **state)
{
    struct extraction extraction = run(noisy, noisy, 128, three_periods);
    for (int k = 0; k < 3; k++) {
        char metric[40];
        snprintf(metric, sizeof(metric), "follow_share_%d", k + 1);
        assert_int_equal(count_where(&extraction, metric, 0.0), PIXELS);
        snprintf(metric, sizeof(metric), "follow_gain_%d_p50", k + 1);
        assert_true(isnan(value_at(&extraction, metric, 5)));
    }
    extraction_end(&extraction);
    extraction = run(lit_and_noisy, noisy, 128, three_periods);
    assert_int_equal(count_where(&extraction, "follow_share_2", 1.0), PIXELS);
    assert_int_equal(count_where(&extraction, "follow_lost_share_2", 1.0), PIXELS);
    assert_true(isnan(value_at(&extraction, "follow_lag_2_p50", 5)));
    extraction_end(&extraction);
    extraction = run(lit_and_noisy, still, 128, three_periods);
    neph_assert_close(value_at(&extraction, "follow_gain_1_p50", 5), 0.0, 0.0, 1e-9);
    assert_int_equal(count_where(&extraction, "follow_lost_share_1", 1.0), PIXELS);
    extraction_end(&extraction);
}

/* A variation below 8 bits is none: 2e-4 peak to peak is 2.6e-3 in luma, below 1/255. */
static void test_floor_and_periods_not_given(void **state)
{
    static const char *const one[] = {"period_2=32", NULL};
    struct extraction extraction = run(dark, dark, 64, one);
    assert_int_equal(count_where(&extraction, "follow_share_2", 1.0), 1);
    assert_true(value_at(&extraction, "follow_share_2", 7) == 1.0);
    assert_true(isnan(value_at(&extraction, "follow_share_1", 7)));
    double value = 0.0;
    assert_non_null(neph_extractor_follow.scalar(extraction.state, 0, &value));
    extraction_end(&extraction);
}

static void test_obstacles(void **state)
{
    static const struct {
        double periods[3];
        int frame_count;
        const char *words; /* NULL: none */
    } cases[] = {
        {{0, 0, 0}, 128, "period_1"},    {{16, 0, 2}, 128, "at least 3"},
        {{0, 64, 0}, 63, "shorter"},     {{0, 64, 0}, 64, NULL},
        {{16, 17, 0}, 128, "too close"}, {{16, 17, 0}, 272, NULL},
        {{5, 3, 4}, 8, "fewer frames"},  {{16, 32, 64}, 0, NULL}, /* unknown length */
        {{32, 32, 0}, 128, "too close"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_settings settings = neph_options_default(neph_extractor_follow.options);
        memcpy(settings.values, cases[i].periods, sizeof(cases[i].periods));
        const struct neph_frame_pair first = {.frame_count = cases[i].frame_count};
        const char *reason = neph_extractor_follow.obstacle(&first, &settings);
        assert_int_equal(reason != NULL, cases[i].words != NULL);
        assert_true(!reason || strstr(reason, cases[i].words));
    }
    extraction_check_table(&neph_extractor_follow);
}

static void test_sequence_too_short(void **state)
{
    struct neph_diag diag = {0};
    struct neph_image *image = grey_image(lit, 0);
    const struct neph_frame_pair pair = extraction_pair(image, NULL, image, "radiance", 0,
                                                        &viewing);
    struct extraction extraction = extraction_begin(&neph_extractor_follow, &pair, three_periods);
    extraction_frame(&extraction, &pair);
    assert_int_equal(neph_extractor_follow.flush(extraction.state, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "1 frames"));
    extraction_end(&extraction);
    neph_image_destroy(image);
}

#include "tests/main.h"

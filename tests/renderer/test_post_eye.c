/* SPDX-License-Identifier: MIT
 *
 * Automatic exposure: percentiles of known histograms, and the adaptation in closed form.
 */
#include "tests/renderer/post_test.h"

enum { width = 67, height = 43, count = width * height };

/* A sequence of frames, and the eye's state. */
struct sequence {
    struct neph_vulkan *vulkan;
    struct neph_post_params params;
    struct neph_exposure_state eye;
    struct neph_image *frame;
    float *rgb[3];
};

static struct sequence open_sequence(struct neph_vulkan *vulkan, const char *settings,
                                     double step_s)
{
    struct sequence s = {.vulkan = vulkan};
    s.params = (struct neph_post_params){.settings = post_settings(settings), .step_s = step_s};
    s.frame = post_image(width, height, s.rgb);
    return s;
}

static void fill(struct sequence *s, double ev)
{
    for (int i = 0; i < count; i++)
        s->rgb[0][i] = s->rgb[1][i] = s->rgb[2][i] = (float)exp2(ev);
}

/* Renders the next frame; `first` (may be NULL) receives the first pixel. */
static struct neph_post_stats next(struct sequence *s, double *first)
{
    struct neph_image *made;
    struct neph_post_stats stats;
    struct neph_diag diag = {0};
    float *rgb[3];
    s->params.eye = &s->eye;
    neph_assert_ok(neph_post_run(s->vulkan, &s->params, s->frame, &made, &stats, &diag), &diag);
    assert_true(neph_image_rgb(made, NULL, rgb));
    if (first)
        *first = rgb[1][0];
    neph_image_destroy(made);
    return stats;
}

#define AUTO "tone=on tone_map=none encode=linear auto_exposure=on "

/* A logarithm of up to 16 in float32; positions in bins are multiples of 1 / 65536. */
static const double ev_tolerance = 4e-6 + 0.25 / 65536;

static void test_a_flat_image_becomes_grey(void **state)
{
    static const double evs[] = {-9.9, -3.1415, -0.125, 0.0, 0.0625, 2.5, 9.87};
    struct sequence s = open_sequence(*state, AUTO, 0.0);
    for (size_t i = 0; i < COUNT(evs); i++) {
        double shown;
        fill(&s, evs[i]);
        s.eye.is_open = false;
        neph_assert_close(next(&s, &shown).adapted_ev, evs[i], 0.0, ev_tolerance);
        neph_assert_close(shown, 0.18, 2.0 * ev_tolerance, 0.0);
    }
    s.params.settings = post_settings(AUTO "exposure_ev=1.5");
    double shown;
    next(&s, &shown);
    neph_assert_close(shown, 0.18 * exp2(1.5), 2.0 * ev_tolerance, 0.0);
    neph_image_destroy(s.frame);
}

/* Equal numbers of pixels at equal distances in EV: the mean between percentiles is the integral of
 * a straight line, up to the width of bins. Then a tenth of black and a tenth of suns. */
static void test_percentiles_of_a_ramp(void **state)
{
    static const struct {
        const char *settings;
        double low, high;
    } cases[] = {{AUTO "meter_low_percent=0 meter_high_percent=100", 0.0, 1.0},
                 {AUTO "meter_low_percent=10 meter_high_percent=90", 0.1, 0.9},
                 {AUTO "meter_low_percent=80 meter_high_percent=98", 0.8, 0.98},
                 {AUTO "meter_low_percent=0 meter_high_percent=20", 0.0, 0.2}};
    const double first_ev = -6.0, range_ev = 8.0;
    struct sequence s = open_sequence(*state, AUTO, 0.0);
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) /* shuffled: 613 is coprime to the count */
            s.rgb[c][i] = (float)exp2(first_ev + range_ev * (i * 613 % count + 0.5) / count);
    for (size_t k = 0; k < COUNT(cases); k++) {
        s.params.settings = post_settings(cases[k].settings);
        s.eye.is_open = false;
        const double mean = first_ev + range_ev * 0.5 * (cases[k].low + cases[k].high);
        /* Bins that a percentile cuts count with their mean, with an error of at most 1/8 EV each;
         * for a quarter of 1.44 EV, the smallest share here. Both on one side: 1/32. */
        neph_assert_close(next(&s, NULL).metered_ev, mean, 0.0, k == 0 ? 1.0 / count : 1.0 / 32.0);
    }
    for (int i = 0; i < count; i++) {
        const double at = (i * 613 % count + 0.5) / count;
        for (int c = 0; c < 3; c++)
            s.rgb[c][i] = at < 0.1 ? 0.0f : at > 0.9 ? 60000.0f : 0.5f;
    }
    s.params.settings = post_settings(AUTO "meter_low_percent=11 meter_high_percent=89");
    s.eye.is_open = false;
    neph_assert_close(next(&s, NULL).metered_ev, -1.0, 0.0, ev_tolerance);
    neph_image_destroy(s.frame);
}

/* The histogram and its percentiles in double, for any image. */
static double metered(const struct sequence *s, double low, double high)
{
    double counts[POST_METER_BINS] = {0}, sums[POST_METER_BINS] = {0}, sum = 0.0, below = 0.0;
    for (int i = 0; i < count; i++) {
        const double y = 0.2126 * s->rgb[0][i] + 0.7152 * s->rgb[1][i] + 0.0722 * s->rgb[2][i];
        const double ev = fmin(fmax(y > 0.0 ? log2(y) : -16.0, -16.0), 16.0);
        const int bin = ev < 16.0 ? (int)((ev + 16.0) * 4.0) : POST_METER_BINS - 1;
        counts[bin] += 1.0;
        sums[bin] += ev;
    }
    for (int bin = 0; bin < POST_METER_BINS; bin++) {
        const double above = below + counts[bin];
        const double inside = fmin(above, high * count) - fmax(below, low * count);
        sum += inside > 0.0 ? inside * sums[bin] / counts[bin] : 0.0;
        below = above;
    }
    return sum / ((high - low) * count);
}

static void test_the_meter_is_its_formula(void **state)
{
    struct sequence s = open_sequence(*state,
                                      AUTO "meter_low_percent=35 meter_high_percent=97.5 "
                                           "exposure_min_ev=-16 exposure_max_ev=16",
                                      0.0);
    for (uint64_t seed = 1; seed <= 4; seed++) {
        uint64_t drawn = seed;
        for (int i = 0; i < count; i++)
            for (int c = 0; c < 3; c++)
                s.rgb[c][i] = i % 11 == 0 ? 0.0f
                                          : (float)exp2(neph_test_uniform(&drawn, -20.0, 5.0) +
                                                        4.0 * (double)seed);
        s.eye.is_open = false;
        /* A pixel at a bin's border may be counted on either side. */
        neph_assert_close(next(&s, NULL).metered_ev, metered(&s, 0.35, 0.975), 0.0,
                          2.0 * ev_tolerance + 0.25 / count);
    }
    neph_image_destroy(s.frame);
}

/* Every pixel counts once, also where groups of threads share the work: 20,467 pixels. */
static void test_the_meter_sees_every_pixel(void **state)
{
    enum { wide = 211, high = 97, all = wide * high };
    static const int bright[] = {0, 1, 4095, 4096, 9001, all - 1, all};
    struct sequence s = open_sequence(*state, AUTO "meter_low_percent=0 meter_high_percent=100",
                                      0.0);
    neph_image_destroy(s.frame);
    s.frame = post_image(wide, high, s.rgb);
    for (size_t k = 0; k < COUNT(bright); k++) {
        for (int i = 0; i < all; i++)
            for (int c = 0; c < 3; c++)
                s.rgb[c][i] = i < bright[k] ? 8.0f : 0.25f;
        s.eye.is_open = false;
        /* One pixel more or less is 2.4e-4. */
        neph_assert_close(next(&s, NULL).metered_ev, -2.0 + 5.0 * bright[k] / all, 0.0,
                          2.0 * ev_tolerance);
    }
    neph_image_destroy(s.frame);
}

/* Colours count with their luminance (ITU-R BT.709). */
static void test_the_meter_sees_luminance(void **state)
{
    static const double weights[3] = {0.2126, 0.7152, 0.0722};
    struct sequence s = open_sequence(*state, AUTO, 0.0);
    for (int bright = 0; bright < 3; bright++) {
        for (int i = 0; i < count; i++)
            for (int c = 0; c < 3; c++)
                s.rgb[c][i] = c == bright ? 0.5f : 0.0f;
        s.eye.is_open = false;
        neph_assert_close(next(&s, NULL).metered_ev, log2(0.5 * weights[bright]), 0.0,
                          ev_tolerance);
    }
    neph_image_destroy(s.frame);
}

/* d/dt = speed min(distance / near, 1) in closed form, from `distance`. */
static double rest_ev(double distance, double speed, double near, double t)
{
    const double far_s = fmax(distance - near, 0.0) / speed;
    if (t < far_s)
        return distance - speed * t;
    return fmin(distance, near) * exp(-(t - far_s) * speed / near);
}

static void test_a_step_of_light_is_approached(void **state)
{
    static const struct {
        double from_ev, to_ev, speed;
    } steps[] = {{-3.0, 2.0, 3.0}, {2.0, -1.5, 1.0}, {0.0, 0.5, 3.0}, {0.25, -0.25, 1.0}};
    const double step_s = 1.0 / 30.0;
    for (size_t k = 0; k < COUNT(steps); k++) {
        struct sequence s = open_sequence(*state, AUTO, step_s);
        fill(&s, steps[k].from_ev);
        next(&s, NULL);
        fill(&s, steps[k].to_ev);
        const double distance = fabs(steps[k].to_ev - steps[k].from_ev);
        const double way = steps[k].to_ev > steps[k].from_ev ? 1.0 : -1.0;
        for (int frame = 1; frame <= 60; frame++) {
            const double rest = rest_ev(distance, steps[k].speed, 1.5, frame * step_s);
            /* Errors of the meter, and one rounding per frame. */
            neph_assert_close(next(&s, NULL).adapted_ev, steps[k].to_ev - way * rest, 0.0,
                              2.0 * ev_tolerance + frame * 1e-6);
        }
        neph_image_destroy(s.frame);
    }
}

/* 30 frames per second and 7 reach the same value. */
static void test_the_way_does_not_know_the_frame_rate(void **state)
{
    double ends[2];
    for (int k = 0; k < 2; k++) {
        const int frames = k ? 7 : 30;
        struct sequence s = open_sequence(*state, AUTO "adapt_up_ev_per_s=4 adapt_near_ev=2",
                                          1.0 / frames);
        fill(&s, -2.0);
        next(&s, NULL);
        fill(&s, 3.0);
        for (int i = 0; i < frames; i++)
            ends[k] = next(&s, NULL).adapted_ev;
        neph_image_destroy(s.frame);
    }
    neph_assert_close(ends[0], ends[1], 0.0, 4e-5);
    neph_assert_close(ends[0], 3.0 - rest_ev(5.0, 4.0, 2.0, 1.0), 0.0, 4e-5);
}

static void test_limits_and_a_stopped_eye(void **state)
{
    struct sequence s = open_sequence(*state, AUTO "exposure_min_ev=-2 exposure_max_ev=1", 0.1);
    fill(&s, -8.0);
    assert_true(next(&s, NULL).adapted_ev == -2.0);
    fill(&s, 8.0);
    s.eye.is_open = false;
    assert_true(next(&s, NULL).adapted_ev == 1.0);
    s.params.settings = post_settings(AUTO "adapt_down_ev_per_s=0");
    fill(&s, -1.0); /* 1 = -1 + 2 through the distance: exact */
    assert_true(next(&s, NULL).adapted_ev == 1.0);
    neph_image_destroy(s.frame);
}

static void test_invalid_metering_is_refused(void **state)
{
    static const char *const wrong[][2] = {
        {AUTO "meter_low_percent=90 meter_high_percent=90", "meter_high_percent"},
        {AUTO "exposure_min_ev=3 exposure_max_ev=2", "exposure_max_ev"},
        {"auto_exposure=on", "tone is off"}};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const struct neph_settings settings = post_settings(wrong[i][0]);
        struct neph_diag diag = {0};
        assert_int_equal(neph_post_check(&settings, &diag), NEPH_ERR_USAGE);
        assert_non_null(strstr(diag.message, wrong[i][1]));
    }
}

#include "tests/renderer/main.h"

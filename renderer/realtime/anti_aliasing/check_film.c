/* SPDX-License-Identifier: MIT
 *
 * Tests of temporal anti-aliasing over many frames: the exponential mean, blur by resampling, the
 * stall of a history in half floats, and bad numbers.
 */
#include "tests/renderer/realtime_test.h"

/* A plain running mean with weight alpha, for which closed forms are valid. */
#define PLAIN "taa_filter=off taa_box=none taa_hdr_weight=off taa_contrast=0 taa_guard=off "

static const double alphas[] = {0.04, 0.1, 0.2, 0.5};
enum { ALPHAS = COUNT(alphas) };

/* A film is a test_passes whose RT_TAA_BEFORE is the last output, on the device and the CPU. */
static void film_open(struct neph_vulkan *vulkan, const char *settings_text, const int size_px[2],
                      struct test_passes *film)
{
    const struct neph_settings settings = test_settings(settings_text);
    test_passes_open(vulkan, &settings, size_px, (int[2]){0, 0}, 0, film);
    film->view.has_history = 1;
    test_fill(film, RT_DEPTH, 128, 0, 0, 0);
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_rt_device_upload(&film->device, RT_DEPTH, film->cpu.targets[RT_DEPTH], &diag), &diag);
}

static void film_upload(struct test_passes *film, int target)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_rt_device_upload(&film->device, target, film->cpu.targets[target], &diag),
                   &diag);
}

/* Sets the history before the first frame. */
static void film_start(struct test_passes *film, float value)
{
    test_fill(film, RT_TAA_BEFORE, value, value, value, 0);
    film_upload(film, RT_TAA_BEFORE);
}

/* Adds one frame, with the colours in the CPU reference's memory. */
static void film_step(struct test_passes *film)
{
    struct neph_diag diag = {0};
    *film->device.view = film->view;
    film_upload(film, RT_COLOR);
    const struct neph_rt_pass *pass = &neph_rt_taa;
    neph_assert_ok(neph_rt_device_run(&film->device, pass, &diag), &diag);
    neph_rt_device_swap_histories(&film->device, pass);
    neph_assert_ok(neph_rt_device_download(&film->device, RT_TAA_BEFORE,
                                           film->cpu.targets[RT_TAA_BEFORE], &diag),
                   &diag);
    film->view.frame++;
}

static float film_value(const struct test_passes *film, size_t index, int channel)
{
    float value[4];
    test_get(film, RT_TAA_BEFORE, index, value);
    return value[channel];
}

/* A running mean with the settings `more`. */
static void open_plain(struct neph_vulkan *vulkan, double alpha, const char *more,
                       const int size_px[2], struct test_passes *film)
{
    char text[256];
    snprintf(text, sizeof(text), PLAIN "taa_alpha=%g %s", alpha, more);
    film_open(vulkan, text, size_px, film);
}

/* --- the exponential mean ----------------------------------------------------------------------
 */

/* A step in red, periods of 4 and 2 frames in green and blue. Results are exact up to float32; the
 * tables have two or three digits. */
static void test_steps_and_strobes_pass_as_alpha_says(void **state)
{
    static const double half_life[] = {17.0, 6.6, 3.1, 1.0}, settled[] = {113, 44, 21, 7};
    static const double at_period_4[] = {0.0289, 0.0743, 0.156, 0.447};
    static const double at_period_2[] = {0.0204, 0.0526, 0.111, 0.333};
    static const float four[] = {2.0f, 1.0f, 0.0f, 1.0f}, two[] = {2.0f, 0.0f};
    for (int a = 0; a < ALPHAS; a++) {
        OWNED(passes) struct test_passes film;
        open_plain(*state, alphas[a], "target_format=float", (int[2]){1, 1}, &film);
        film_start(&film, 1.0f);
        double left_before = 1.0, crossed_half = 0.0, last_four[4];
        int one_percent = 0;
        for (int frame = 0; frame < 200; frame++) {
            test_set(&film, RT_COLOR, 0, (float[4]){2.0f, four[frame % 4], two[frame % 2]});
            film_step(&film);
            const double left = 2.0 - film_value(&film, 0, 0);
            if (left_before > 0.5 && left <= 0.5) /* interpolated exponentially */
                crossed_half = frame + log(left_before / 0.5) / log(left_before / left);
            one_percent += left > 0.01;
            left_before = left > 0.0 ? left : left_before;
            last_four[frame % 4] = film_value(&film, 0, 1);
        }
        neph_assert_close(crossed_half, half_life[a], 0.02, 0.0);
        neph_assert_close(one_percent + 1, settled[a], 0.0, 1.0); /* whole frames */
        neph_assert_close(hypot(last_four[0] - last_four[2], last_four[1] - last_four[3]) / 2.0,
                          at_period_4[a], 0.02, 0.0);
        neph_assert_close(1.0 - film_value(&film, 0, 2), at_period_2[a], 0.02, 0.0);
    }
}

/* --- resampling --------------------------------------------------------------------------------
 */

enum { WALL_PX = 256 };

/* 256x1 pixels of 1 m at 128 m, moving by `speed_px` a frame to the left; a Gaussian of 2 px on
 * them ends at pixel 96. Returns its place and variance in the history of 10 / alpha frames. */
static void pan(struct neph_vulkan *vulkan, double alpha, const char *words, double speed_px,
                double *centre_px, double *variance_px2)
{
    static const double sigma_px = 2.0;
    const int frames = (int)(10.0 / alpha);
    OWNED(passes) struct test_passes film;
    /* From 20 px on the frame's weight is 0.2: this weight without motion gives `alpha` here. */
    const double quickness = speed_px / 20.0;
    open_plain(vulkan, (alpha - 0.2 * quickness) / (1.0 - quickness), words, (int[2]){WALL_PX, 1},
               &film);
    film.view.now.half_width = film.view.before.half_width = 1.0f;
    film.view.before.position_m[0] = -(float)speed_px;
    for (int frame = 0; frame < frames; frame++) {
        const double at_px = 96.0 + speed_px * (frames - 1 - frame);
        for (int x = 0; x < WALL_PX; x++) {
            const double way = (x + 0.5 - at_px) / sigma_px;
            const float value = (float)exp(-0.5 * way * way);
            test_set(&film, RT_COLOR, (size_t)x, (float[4]){value, value, value});
        }
        film_step(&film);
    }
    double sums[3] = {0.0};
    for (int x = 0; x < WALL_PX; x++) {
        const double value = film_value(&film, (size_t)x, 0), way = x + 0.5 - 96.0;
        sums[0] += value;
        sums[1] += value * way;
        sums[2] += value * way * way;
    }
    *centre_px = sums[1] / sums[0];
    *variance_px2 = sums[2] / sums[0] - *centre_px * *centre_px - sigma_px * sigma_px;
}

/* Each bilinear sample between pixels adds a variance of v (1 - v) px^2, and a frame of age k has
 * had k samples: (1 - a) / a v (1 - v) in total. Frames older than 10 / a are missing: at most
 * 0.96^250 of the weight, times their age in mean ages, 4e-4. */
static void test_bilinear_history_blurs_as_alpha_says(void **state)
{
    static const double table_px[] = {2.45, 1.50, 1.00, 0.50};
    for (int a = 0; a < ALPHAS; a++) {
        static const char words[] = "target_format=float taa_history=bilinear";
        double centre_px, variance_px2;
        pan(*state, alphas[a], words, 0.5, &centre_px, &variance_px2);
        neph_assert_close(sqrt(variance_px2), table_px[a], 0.02, 0.0);
        neph_assert_close(centre_px, 0.0, 0.0, 0.001); /* no lag */
        pan(*state, alphas[a], words, 0.25, &centre_px, &variance_px2);
        neph_assert_close(variance_px2, (1.0 - alphas[a]) / alphas[a] * 0.25 * 0.75, 0.01, 0.0);
    }
}

/* Catmull-Rom reproduces parabolas: it does not change the variance. float32 loses some 1e-7 of
 * values up to 1 each frame, at up to 128 px from the centre; the Gaussian's sum is 5. */
static void test_catmull_rom_does_not_widen(void **state)
{
    static const char words[] = "target_format=float taa_history=catmull_rom";
    double centre_px, variance_px2;
    pan(*state, 0.04, words, 0.5, &centre_px, &variance_px2);
    neph_assert_close(variance_px2, 0.0, 0.0, 0.02);
    neph_assert_close(centre_px, 0.0, 0.0, 0.001);
}

/* --- halves ------------------------------------------------------------------------------------
 */

/* 64 pixels whose frame is 0 .. 63 ulps above the history of 1: each step of the mean is rounded to
 * whole ulps, and a step of 0.04 d < 1/2 to 0. So the history stays 12 ulps below, 1.2 %. */
static void test_a_history_in_halves_stalls(void **state)
{
    OWNED(passes) struct test_passes film;
    open_plain(*state, 0.04, "target_format=half taa_rounding=nearest", (int[2]){64, 1}, &film);
    film_start(&film, 1.0f);
    for (size_t x = 0; x < 64; x++) {
        const float value = 1.0f + (float)x * 0x1p-10f;
        test_set(&film, RT_COLOR, x, (float[4]){value, value, value});
    }
    for (int frame = 0; frame < 200; frame++)
        film_step(&film);
    for (int x = 0; x < 64; x++)
        assert_true(film_value(&film, (size_t)x, 1) ==
                    1.0f + (float)(x < 12 ? 0 : x - 12) * 0x1p-10f);
}

/* --- bad numbers ---------------------------------------------------------------------------  */

static int count_nan(const struct test_passes *film)
{
    int count = 0;
    for (size_t i = 0; i < test_elements(film, RT_TAA_BEFORE); i++)
        count += isnan(film_value(film, i, 0));
    return count;
}

/* A NaN in a pixel of one frame. The filter spreads it to 3x3 pixels. Where the camera moves along
 * x by a part of a pixel Catmull-Rom reads four texels of a row: 3 more columns in each frame. The
 * clamp does not change a NaN. */
static void test_a_nan_grows_without_guard_only(void **state)
{
    static const struct {
        const char *settings;
        float way_m;
        int counts[3]; /* in its frame and in the next two */
    } cases[] = {{"taa_guard=off", 0.3f, {9, 18, 27}},
                 {"taa_guard=off", 0.0f, {9, 9, 9}},
                 {"taa_guard=on", 0.3f, {0, 0, 0}}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes film;
        film_open(*state, cases[i].settings, (int[2]){32, 32}, &film);
        film_start(&film, 1.0f);
        film.view.before.position_m[0] = cases[i].way_m;
        for (int frame = 0; frame < 3; frame++) {
            test_fill(&film, RT_COLOR, 1, 1, 1, 0);
            if (frame == 0)
                test_set(&film, RT_COLOR, 16 * 32 + 16, (float[4]){NAN, NAN, NAN});
            film_step(&film);
            assert_int_equal(count_nan(&film), cases[i].counts[frame]);
        }
    }
}

/* Black over black: the contrast law is 0.01 * 0 / 0. */
static void test_black_over_black_is_nan_without_guard_only(void **state)
{
    static const char *const guards[] = {"taa_guard=off", "taa_guard=on"};
    for (int guard = 0; guard < 2; guard++) {
        OWNED(passes) struct test_passes film;
        film_open(*state, guards[guard], (int[2]){8, 8}, &film);
        film_start(&film, 0.0f);
        film_step(&film);
        assert_int_equal(count_nan(&film), guard ? 0 : 64);
        for (size_t i = 0; i < 64 && guard; i++)
            assert_true(film_value(&film, i, 0) == 0.0f);
    }
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Tests of the blend and the output of anti-aliasing against closed forms: weights, ages, changing
 * light, media without motion vectors, exposure, rounding. */
#include "renderer/realtime/anti_aliasing/check_taa.h"

#include "renderer/realtime/pipeline.h"

static void run(struct test_passes *test, const char *pass)
{
    test_passes_run(test, pass);
    test_take(test, RT_TAA_OUT);
}

/* 256x64 pixels of 1 m each at 128 m: exact in float32. */
static void open_wall(struct neph_vulkan *vulkan, const char *settings_text,
                      struct test_passes *test)
{
    const struct neph_settings settings = test_settings(settings_text);
    test_passes_open(vulkan, &settings, (int[2]){256, 64}, (int[2]){0, 0}, 0, test);
    test->view.has_history = 1;
    test->view.now.half_width = test->view.before.half_width = 1.0f;
    test->view.now.half_height = test->view.before.half_height = 0.25f;
    test_fill(test, RT_DEPTH, 128, 0, 0, 0);
}

/* Weight of a frame with taa_alpha=0. */
static double moving_weight(double speed_px)
{
    return 0.2 * fmin(speed_px / 20.0, 1.0);
}

/* --- the blend and the format --------------------------------------------------------------- */

/* The weight of a frame against a history, from the output. */
static double find_weight(double out, double frame, double history)
{
    return (out - history) / (frame - history);
}

/* alpha = max(.04, min(1, .01 / r)) for a frame that differs by r of the history's luma: noise
 * below 1 % is not averaged at all. Colours are exact to some ulps, the weight to that over r. */
static void test_the_contrast_law_takes_small_differences_whole(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 64, 2, 0, &test,
              "taa_filter=off taa_box=none taa_hdr_weight=off target_format=float");
    test.view.has_history = 1;
    const float luma = 3.0f;
    for (int x = 0; x < 64; x++) {
        const double r = pow(10.0, -3.0 + 4.0 * x / 63.0);
        const float above = (float)(luma * (1.0 + r)), below = (float)(luma * (1.0 - fmin(r, 0.9)));
        for (int y = 0; y < 2; y++) {
            cpu_put_full(&test.cpu, RT_DEPTH, x, y, (float[4]){1.0f});
            cpu_put_full(&test.cpu, RT_TAA_BEFORE, x, y, (float[4]){luma, luma, luma});
            const float value = y ? below : above;
            cpu_put_full(&test.cpu, RT_COLOR, x, y, (float[4]){value, value, value});
        }
    }
    run(&test, "anti-aliasing");
    for (int x = 0; x < 64; x++)
        for (int y = 0; y < 2; y++) {
            const double frame = pixel_value(&test, RT_COLOR, x, y, 0);
            const double r = fabs(frame / luma - 1.0);
            const double alpha = find_weight(pixel_value(&test, RT_TAA_OUT, x, y, 0), frame, luma);
            neph_assert_close(alpha, fmax(0.04, fmin(1.0, 0.01 / r)), 0.0,
                              8.0 * float_ulp * (1.0 + r) / r);
        }
}

/* From taa_alpha for static pixels to 0.2 at 20 pixels and beyond. */
static void test_the_weight_grows_with_speed(void **state)
{
    OWNED(passes) struct test_passes test;
    open_wall(*state,
              "taa_filter=off taa_box=none taa_hdr_weight=off taa_contrast=0 target_format=float",
              &test);
    test_fill(&test, RT_COLOR, 1, 1, 1, 0);
    for (int speed_px = 0; speed_px <= 60; speed_px += 5) {
        /* 3 : 4 : 5 */
        test.view.before.position_m[0] = 0.8f * (float)speed_px;
        test.view.before.position_m[1] = 0.6f * (float)speed_px;
        run(&test, "anti-aliasing");
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 128, 20, 0),
                          0.04 + 0.16 * fmin(speed_px / 20.0, 1.0), 1e-6, 0.0);
    }
}

/* --- static pixels, and motion with the medium ---------------------------------------------- */

/* After n frames the pixel is their mean, for any values: no box, no contrast law. */
static void test_a_static_pixel_is_the_mean_of_its_frames(void **state)
{
    enum { FRAMES = 12, AGE_MAX = 8 };
    static const float frames[FRAMES] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8};
    OWNED(passes) struct test_passes test;
    open_wall(*state,
              "taa_filter=off taa_hdr_weight=off target_format=float gradient=on taa_age_max=8",
              &test);
    double mean = 0.0;
    for (int n = 0; n < FRAMES; n++) {
        test.view.has_history = n > 0;
        test_fill(&test, RT_COLOR, frames[n], frames[n], frames[n], 0);
        run(&test, "anti-aliasing");
        mean += (frames[n] - mean) / (n < AGE_MAX ? n + 1 : AGE_MAX + 1);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 99, 33, 1), mean, 0.0, 1e-5);
        assert_true(pixel_value(&test, RT_TAA_OUT, 99, 33, 3) == (n < AGE_MAX ? n + 1 : AGE_MAX));
        test_swap(&test, RT_TAA_BEFORE, RT_TAA_OUT);
    }
}

static void put_change(struct test_passes *test, int target, float gain, float residue)
{
    test_fill(test, target, gain, gain, gain, residue);
}

/* A change of the light of the medium or behind it, and motion (in parts of 0.02 px), each restore
 * weight and box: fully at twice the limit, by half at one and a half. The age decreases by the
 * same share, and is limited before to the number of frames that are alike within the limit. */
static void test_change_and_motion_begin_a_new_mean(void **state)
{
    static const struct {
        float medium, behind, motion;
        double part,
            age; /* age after the change, from 19: 4 frames, 7 behind, times 0.2 / change */
    } cases[] = {{0.0f, 0.0f, 0.0f, 0.0, 19.0}, {0.1f, 0.0f, 0.0f, 0.0, 8.0},
                 {0.2f, 0.0f, 0.0f, 0.0, 4.0},  {0.3f, 0.0f, 0.0f, 0.5, 8.0 / 3.0},
                 {0.4f, 0.0f, 0.0f, 1.0, 2.0},  {0.0f, 0.3f, 0.0f, 0.5, 14.0 / 3.0},
                 {0.1f, 0.1f, 0.0f, 0.0, 8.0},  {0.0f, 0.9f, 0.0f, 1.0, 14.0 / 9.0},
                 {0.0f, 0.0f, 1.0f, 0.0, 19.0}, {0.0f, 0.0f, 1.5f, 0.5, 19.0},
                 {0.0f, 0.0f, 2.0f, 1.0, 19.0}};
    OWNED(passes) struct test_passes test;
    open_wall(*state,
              "taa_filter=off taa_hdr_weight=off taa_contrast=0 target_format=float taa_alpha=0.25 "
              "gradient=on taa_age_max=64 taa_change=0.2",
              &test);
    test_fill(&test, RT_COLOR, 2, 2, 2, 0);
    test_fill(&test, RT_TAA_BEFORE, 1, 1, 1, 19);
    for (size_t i = 0; i < COUNT(cases); i++) {
        put_change(&test, RT_CHANGE, 1.0f, cases[i].medium);
        put_change(&test, RT_CHANGE_BEHIND, 1.0f, cases[i].behind);
        test.view.before.position_m[0] = 0.02f * cases[i].motion;
        run(&test, "anti-aliasing");
        const double part = cases[i].part, age = cases[i].age;
        const double alpha = part * 0.25 + (1.0 - part) / (age + 1.0);
        /* the box of a flat frame is the frame; a motion is exact to 1e-4 px of 0.02 */
        const double error = cases[i].motion > 0.0f ? motion_error_px / 0.02 : 1e-5;
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0),
                          2.0 - (1.0 - alpha) * (1.0 - part), 0.0, error);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 3),
                          (1.0 - part) * (age + 1.0) + part, 0.0, 20.0 * error);
    }
}

/* A wall of light 2, whose history is 1 with an age, and a change of the medium's light. */
static void open_change(struct neph_vulkan *vulkan, const char *settings, float age, float residue,
                        struct test_passes *test)
{
    open_wall(vulkan, settings, test);
    test_fill(test, RT_COLOR, 2, 2, 2, 0);
    test_fill(test, RT_TAA_BEFORE, 1, 1, 1, age);
    put_change(test, RT_CHANGE, 1.0f, residue);
    put_change(test, RT_CHANGE_BEHIND, 1.0f, 0.0f);
}

/* The light of a pixel changes fully in one frame, or the pixel moves by `motion` px in it; then
 * both are constant. The changed frame counts 1 in the mean, or 1/4 where the mean has less than
 * two frames; the mean keeps at most taa_age_least frames, and the n-th frame after the change
 * weighs 1 / (age + n). A residue of 1 is another scene: the age is 1. */
static void test_mean_keeps_frames_after_a_change(void **state)
{
    static const struct {
        const char *least;
        float age, residue, motion_px;
        double kept;
    } cases[] = {{"0", 40, 0.4f, 0, 1},    {"1", 40, 0.4f, 0, 1},    {"19", 40, 0.4f, 0, 19},
                 {"19", 19, 0.4f, 0, 19},  {"19", 18, 0.4f, 0, 19},  {"19", 5, 0.4f, 0, 6},
                 {"19", 1, 0.4f, 0, 1.25}, {"19", 2, 0.4f, 0, 3},    {"19", 1.75f, 0.4f, 0, 2},
                 {"100", 70, 0.4f, 0, 64}, {"19", 40, 0, 0.05f, 19}, {"19", 40, 1, 0, 1},
                 {"19", 40, 0.99f, 0, 19}, {"19", 40, 0, 1, 19},     {"19", 5, 0, 1, 6},
                 {"0", 40, 0, 1, 1}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        char text[256];
        snprintf(text, sizeof(text),
                 "taa_filter=off taa_hdr_weight=off taa_contrast=0 target_format=float "
                 "taa_alpha=0.25 gradient=on taa_age_max=64 taa_change=0.2 taa_age_least=%s",
                 cases[i].least);
        open_change(*state, text, cases[i].age, cases[i].residue, &test);
        test.view.before.position_m[0] = cases[i].motion_px;
        run(&test, "anti-aliasing");
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0), 2.0, 0.0, 1e-5);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 3), cases[i].kept, 0.0, 1e-5);
        put_change(&test, RT_CHANGE, 1.0f, 0.0f);
        test.view.before.position_m[0] = 0.0f;
        double mean = 2.0;
        for (int n = 1; n <= 4; n++) {
            const float frame = n % 2 ? 3.0f : 1.0f;
            test_swap(&test, RT_TAA_BEFORE, RT_TAA_OUT);
            test_fill(&test, RT_COLOR, frame, frame, frame, 0);
            run(&test, "anti-aliasing");
            mean += (frame - mean) / fmin(cases[i].kept + n, 65.0);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0), mean, 0.0, 1e-5);
        }
    }
}

/* A slow change limits the age to the frames that are alike, 4 for a change of taa_change in four
 * frames. The limit is not below taa_age_least. */
static void test_slow_changes_keep_frames(void **state)
{
    static const struct {
        const char *least;
        float age, residue;
        double limited;
    } cases[] = {{"0", 40, 0.2f, 4},   {"3", 40, 0.2f, 4}, {"19", 40, 0.2f, 19}, {"19", 7, 0.2f, 7},
                 {"19", 40, 0.1f, 19}, {"6", 40, 0.1f, 8}, {"19", 40, 0.0f, 40}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        char text[256];
        snprintf(text, sizeof(text),
                 "taa_filter=off taa_hdr_weight=off target_format=float gradient=on "
                 "taa_age_max=64 taa_change=0.2 taa_age_least=%s",
                 cases[i].least);
        open_change(*state, text, cases[i].age, cases[i].residue, &test);
        run(&test, "anti-aliasing");
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0),
                          1.0 + 1.0 / (cases[i].limited + 1.0), 0.0, 1e-5);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 3), cases[i].limited + 1.0, 0.0,
                          1e-4);
    }
}

/* A change counts in proportion between taa_change and taa_change_full: at the middle by half. The
 * last two have no ramp between their limits; neph_realtime_can_render() refuses them. */
static void test_changes_count_between_their_limits(void **state)
{
    static const struct {
        const char *words;
        float residue;
        double part;
    } cases[] = {{"taa_change=0.2 taa_change_full=0", 0.3f, 0.5},
                 {"taa_change=0.2 taa_change_full=0.6", 0.2f, 0.0},
                 {"taa_change=0.2 taa_change_full=0.6", 0.3f, 0.25},
                 {"taa_change=0.2 taa_change_full=0.6", 0.4f, 0.5},
                 {"taa_change=0.2 taa_change_full=0.6", 0.6f, 1.0},
                 {"taa_change=0.2 taa_change_full=0.6", 0.9f, 1.0},
                 {"taa_change=0.2 taa_change_full=0.25", 0.225f, 0.5},
                 {"taa_change=0 taa_change_full=0.5", 0.0f, 0.0},
                 {"taa_change=0 taa_change_full=0.5", 0.25f, 0.5},
                 {"taa_change=0.2 taa_change_full=0.2", 0.2f, 0.0},
                 {"taa_change=0.2 taa_change_full=0.1", 0.3f, 1.0}};
    for (size_t i = 0; i < COUNT(cases); i++)
        for (int medium = 0; medium < 2; medium++) {
            OWNED(passes) struct test_passes test;
            char text[256];
            snprintf(text, sizeof(text),
                     "taa_filter=off taa_box=none taa_hdr_weight=off taa_contrast=0 "
                     "target_format=float taa_alpha=0.75 gradient=on taa_age_max=64 %s",
                     cases[i].words);
            open_wall(*state, text, &test);
            test_fill(&test, RT_COLOR, 2, 2, 2, 0);
            test_fill(&test, RT_TAA_BEFORE, 1, 1, 1, 1);
            put_change(&test, RT_CHANGE, 1.0f, medium ? cases[i].residue : 0.0f);
            put_change(&test, RT_CHANGE_BEHIND, 1.0f, medium ? 0.0f : cases[i].residue);
            run(&test, "anti-aliasing");
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0),
                              1.0 + 0.5 + 0.25 * cases[i].part, 0.0, 1e-5);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 3), 2.0 - cases[i].part, 0.0,
                              1e-5);
        }
}

static void test_limits_of_a_change_in_the_wrong_order_are_an_error(void **state)
{
    (void)state;
    static const struct {
        const char *words;
        bool is_fine;
    } cases[] = {{"taa_change=0.1 taa_change_full=0", true},
                 {"taa_change=0.1 taa_change_full=0.2", true},
                 {"taa_change=0 taa_change_full=0.001", true},
                 {"taa_change=0.1 taa_change_full=0.1", false},
                 {"taa_change=0.1 taa_change_full=0.1000000001", false}, /* equal in float32 */
                 {"taa_change=0.1 taa_change_full=0.05", false}};
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.03, 0.05, 0.0);
    for (size_t i = 0; i < COUNT(cases); i++) {
        char reason[256] = "";
        const struct neph_settings settings = test_settings(cases[i].words);
        assert_true(neph_realtime_can_render(&test.scene, &settings, reason, sizeof(reason)) ==
                    cases[i].is_fine);
        assert_true(cases[i].is_fine || strstr(reason, "set taa_change_full above taa_change"));
    }
}

/* Static history is multiplied by the gain of the pixel's light: the gains of medium and background
 * weighted by their shares. Moving history is not. */
static void test_history_takes_the_light_along(void **state)
{
    static const struct {
        double share, medium, behind, motion, gain; /* share of the medium; motion / 0.02 px */
    } cases[] = {{1.0, 0.98, 1.0, 0.0, 0.98},
                 {0.0, 0.98, 1.0, 0.0, 1.0},
                 {0.5, 0.98, 1.02, 0.0, 1.0 / (0.5 / 0.98 + 0.5 / 1.02)},
                 {0.25, 1.05, 1.0, 0.0, 1.0 / (0.25 / 1.05 + 0.75)},
                 {1.0, 0.98, 0.98, 1.5, 0.99},
                 {1.0, 0.98, 0.98, 2.0, 1.0}};
    OWNED(passes) struct test_passes test;
    open_wall(*state,
              "taa_filter=off taa_hdr_weight=off taa_box=none taa_contrast=0 target_format=float "
              "taa_alpha=0 gradient=on taa_age_max=64 relight=0.1",
              &test);
    for (size_t i = 0; i < COUNT(cases); i++) {
        for (size_t e = 0; e < test_elements(&test, RT_COLOR); e++) {
            const float medium = (float)(2.0 * cases[i].share);
            test_set(&test, RT_COLOR, e, (float[4]){2.0f, 2.0f, 2.0f});
            test_set(&test, RT_VOLUME, e, (float[4]){medium, medium, medium, 0.5f});
            test_set(&test, RT_TAA_BEFORE, e, (float[4]){1.0f, 1.0f, 1.0f, 64.0f});
        }
        put_change(&test, RT_CHANGE, (float)cases[i].medium, 0.0f);
        put_change(&test, RT_CHANGE_BEHIND, (float)cases[i].behind, 0.0f);
        test.view.before.position_m[0] = (float)(0.02 * cases[i].motion);
        run(&test, "anti-aliasing");
        const double moved = fmax(cases[i].motion - 1.0, 0.0);
        const double alpha = (1.0 - moved) / 65.0;
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 80, 34, 0),
                          cases[i].gain + alpha * (2.0 - cases[i].gain), 0.0,
                          moved > 0.0 ? motion_error_px / 0.02 : 1e-5);
    }
}

/* Without a gradient changes are not detected: no pixel is static. */
static void test_without_a_gradient_no_pixel_is_static(void **state)
{
    OWNED(passes) struct test_passes test;
    open_wall(*state,
              "taa_filter=off taa_hdr_weight=off taa_box=none taa_contrast=0 target_format=float "
              "taa_alpha=0.25 taa_age_max=64",
              &test);
    for (size_t e = 0; e < test_elements(&test, RT_COLOR); e++)
        test_set(&test, RT_TAA_BEFORE, e, (float[4]){1.0f, 1.0f, 1.0f, 19.0f});
    run(&test, "anti-aliasing");
    neph_assert_close(pixel_value(&test, RT_TAA_OUT, 99, 33, 0), 0.75, 0.0, 1e-6);
}

/* The wind moves clouds at 128 m, in front of a wall at 200 m, by 8 pixels; clouds at half that
 * distance move by 16. Their motion is used for the sky and for surfaces that they hide by more
 * than half; not for surfaces in front of them, and not in constant light. */
static void test_the_history_goes_with_the_medium(void **state)
{
    static const struct {
        const char *words;
        float through, distance_m, scene_m;
        int motion_px;
    } cases[] = {{"wind=on", 0.0f, 128.0f, 200.0f, 8},
                 {"wind=on", 0.4f, 64.0f, 128.0f, 16},
                 {"wind=on", 0.6f, 64.0f, 128.0f, 0},
                 {"wind=on", 0.9f, 64.0f, NEPH_GPU_FAR_M, 16},
                 {"wind=on", 1.0f, 128.0f, NEPH_GPU_FAR_M, 0},
                 {"wind=off", 0.0f, 128.0f, 200.0f, 0},
                 {"wind=on", 0.5f, 0.0f, NEPH_GPU_FAR_M, 0},
                 {"wind=on", 0.0f, 128.0f, 64.0f, 0},
                 {"gradient=on taa_age_max=1 taa_change=0.2", 0.0f, 64.0f, 128.0f, 0},
                 {"gradient=on taa_age_max=1 taa_change=0.01", 0.0f, 64.0f, 128.0f, 16}};
    uint64_t seed = 3;
    for (size_t i = 0; i < COUNT(cases); i++) {
        char text[256];
        snprintf(text, sizeof(text),
                 "taa_filter=off taa_box=none taa_alpha=0 taa_contrast=0 taa_hdr_weight=off "
                 "target_format=float taa_history=nearest taa_medium=on %s",
                 cases[i].words);
        OWNED(passes) struct test_passes test;
        open_wall(*state, text, &test);
        fill_colours(&test, RT_TAA_BEFORE, 3.0, &seed);
        put_change(&test, RT_CHANGE, 1.0f, 0.1f);
        for (int y = 0; y < 64; y++)
            for (int x = 0; x < 256; x++) {
                cpu_put_full(&test.cpu, RT_DEPTH, x, y, (float[4]){cases[i].scene_m});
                /* along the ray, which is longer towards the sides */
                const double across = (2.0 * (x + 0.5) / 256.0 - 1.0),
                             up = (1.0 - 2.0 * (y + 0.5) / 64.0) * 0.25;
                const double slant = sqrt(1.0 + across * across + up * up);
                cpu_put_full(&test.cpu, RT_VOLUME, x, y,
                             (float[4]){0.0f, 0.0f, 0.0f, cases[i].through});
                cpu_put_full(&test.cpu, RT_VOLUME_DISTANCE, x, y,
                             (float[4]){(float)(slant * (double)cases[i].distance_m)});
            }
        test.view.wind_m[0] = 8.0f;
        run(&test, "anti-aliasing");
        /* a static pixel is the mean of the frame, which is black, and one before */
        const bool is_mean = i == 8;
        const double weight = is_mean ? 0.5 : moving_weight(cases[i].motion_px);
        for (int y = 0; y < 64; y++)
            for (int x = 16; x < 256; x++)
                for (int c = 0; c < 3; c++)
                    neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, c),
                                      (1.0 - weight) * pixel_value(&test, RT_TAA_BEFORE,
                                                                   x - cases[i].motion_px, y, c),
                                      1e-5, 0.0);
    }
}

/* With alpha = 1, for any history; and values are limited to 65504, with or without the guard. */
static void test_frame_of_full_weight_is_unchanged(void **state)
{
    static const char *const guards[] = {"taa_guard=off", "taa_guard=on"};
    static const float frames[] = {0.001f, 0.7f, 65504.0f, 1e5f};
    for (int i = 0; i < 8; i++) {
        OWNED(passes) struct test_passes test;
        test_open(*state, 1, 1, 0, &test,
                  "taa_filter=off taa_box=none taa_alpha=1 target_format=float %s", guards[i / 4]);
        test.view.has_history = 1;
        const float frame = frames[i % 4];
        test_set(&test, RT_DEPTH, 0, (float[4]){1.0f});
        test_set(&test, RT_COLOR, 0, (float[4]){frame, frame, frame});
        test_set(&test, RT_TAA_BEFORE, 0, (float[4]){6e4f, 6e4f, 6e4f});
        run(&test, "anti-aliasing");
        assert_true(pixel_value(&test, RT_TAA_OUT, 0, 0, 0) ==
                    (double)(frame < 65504.0f ? frame : 65504.0f));
    }
}

/* Weights 1 / (Y + 4), Y four times the luma: in a blend of alpha 0.5 the darker colour
 * dominates. */
static void test_hdr_weights_reduce_bright_samples(void **state)
{
    OWNED(passes) struct test_passes test;
    test_open(*state, 1, 1, 0, &test,
              "taa_filter=off taa_box=none taa_alpha=0.5 taa_contrast=0 target_format=float");
    test.view.has_history = 1;
    test_set(&test, RT_DEPTH, 0, (float[4]){1.0f});
    test_set(&test, RT_COLOR, 0, (float[4]){9.0f, 9.0f, 9.0f});
    test_set(&test, RT_TAA_BEFORE, 0, (float[4]){1.0f, 1.0f, 1.0f});
    run(&test, "anti-aliasing");
    const double dark = 1.0 / 8.0, bright = 1.0 / 40.0;
    neph_assert_close(pixel_value(&test, RT_TAA_OUT, 0, 0, 0),
                      (1.0 * dark + 9.0 * bright) / (dark + bright), 1e-6, 0.0);
}

/* Every output is one of the two halves around the exact value, bit by bit the choice of the CPU
 * reference, and the mean of 12288 outputs is the value: to 4 standard errors, a half's step / 2 /
 * sqrt(12288) each. */
static void try_rounding_by_chance(struct neph_vulkan *vulkan, uint64_t seed)
{
    static const double values[] = {1.0, 1.0003, 0.7777, 0x10dfp-37, 0xd6cp-37, 65503.0, 0.0};
    OWNED(passes) struct test_passes test;
    test_open(vulkan, 64, 64, seed, &test, "taa_filter=off");
    for (size_t v = 0; v < COUNT(values); v++) {
        const float value = (float)values[v];
        test.view.frame = (uint32_t)v;
        test_fill(&test, RT_COLOR, value, value, value, 0);
        test_passes_run(&test, "anti-aliasing");
        cpu_taa(&test.cpu);
        test_same_words(&test, RT_TAA_OUT, v);
        const double step = fmax(ldexp(1.0, ilogb(values[v] > 0.0 ? values[v] : 1.0) - 10),
                                 0x1p-24);
        double sum = 0.0;
        for (int i = 0; i < 3 * 64 * 64; i++) {
            const double out = pixel_value(&test, RT_TAA_OUT, i / 3 % 64, i / 192, i % 3);
            assert_true(fabs(out - (double)value) < step);
            sum += out;
        }
        neph_assert_close(sum / (3 * 64 * 64), value, 0.0, 4.0 * 0.5 * step / sqrt(3 * 64 * 64));
    }
}

/* In floats, and in integers as on a GPU: the same choice of each number. Below 2^-14 a GPU
 * represents a value to 2^-37. */
static void test_rounding_by_chance_is_right_on_average(void **state)
{
    for (uint64_t seed = 0; seed < 2; seed++)
        try_rounding_by_chance(*state, seed);
}

/* --- in upsampling, too ----------------------------------------------------------------------- */

static const struct {
    const char *words, *pass;
} passes[] = {{"taa=on", "anti-aliasing"}, {"taa=upsampling", "upsampling"}};

/* 16x8 pixels at 128 m; everything but alpha is off. */
static void open_plain(struct neph_vulkan *vulkan, int p, const char *words,
                       struct test_passes *test)
{
    test_open(vulkan, 16, 8, 0, test,
              "taa_filter=off taa_box=none taa_hdr_weight=off taa_contrast=0 target_format=float "
              "taa_alpha=0.125 %s %s",
              passes[p].words, words);
    test->view.has_history = 1;
    test_fill(test, RT_DEPTH, 128, 0, 0, 0);
    test_fill(test, RT_COLOR, 2, 2, 2, 0);
    test_fill(test, RT_TAA_BEFORE, 1, 1, 1, 0);
    test_fill(test, RT_VOLUME, 0, 0, 0, 1);
}

/* Where more than half of the light is the medium's, the frame's weight is at least a quarter. */
static void test_media_are_responsive(void **state)
{
    static const struct {
        const char *words;
        float through;
        double weight;
    } cases[] = {{"taa_responsive=off", 0.1f, 0.125},
                 {"taa_responsive=medium", 0.1f, 0.25},
                 {"taa_responsive=medium", 0.49f, 0.25},
                 {"taa_responsive=medium", 0.5f, 0.125},
                 {"taa_responsive=medium taa_alpha=0.75", 0.1f, 0.75}};
    for (int p = 0; p < 2; p++)
        for (size_t i = 0; i < COUNT(cases); i++) {
            OWNED(passes) struct test_passes test;
            open_plain(*state, p, cases[i].words, &test);
            test_fill(&test, RT_VOLUME, 0, 0, 0, cases[i].through);
            run(&test, passes[p].pass);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 7, 3, 1), 1.0 + cases[i].weight, 0.0,
                              1e-6);
        }
}

/* Light of 2 and a history of 1 that was stored at half the exposure. Both are stored exposed; the
 * history is converted from its own frame's exposure only with taa_pre_exposure. */
static void test_history_follows_the_exposure(void **state)
{
    static const struct {
        const char *words;
        double kept;
    } cases[] = {{"taa_pre_exposure=off", 0.875 * 0.5 + 0.125 * 16.0},
                 {"taa_pre_exposure=on", 0.875 * 8.0 + 0.125 * 16.0}};
    for (int p = 0; p < 2; p++)
        for (int i = 0; i < 2; i++) {
            OWNED(passes) struct test_passes test;
            open_plain(*state, p, cases[i].words, &test);
            test.view.exposure = 8.0f;
            test.view.exposure_before = 0.5f;
            test_fill(&test, RT_TAA_BEFORE, 0.5f, 0.5f, 0.5f, 0);
            run(&test, passes[p].pass);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 7, 3, 2), cases[i].kept, 1e-6, 0.0);
        }
}

#include "tests/renderer/main.h"

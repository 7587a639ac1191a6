/* SPDX-License-Identifier: MIT
 *
 * Tests of upsampling with locks against its CPU reference, and of each of its parts: thin features
 * are locked, disoccluded pixels have no history, a history is weighted by its accumulated weight.
 */
#include "renderer/realtime/anti_aliasing/check_taa.h"

static void run(struct test_passes *test)
{
    test_passes_run(test, "locks");
    test_take(test, RT_TAA_OUT);
    test_take(test, RT_TAA_STATE);
}

/* --- against the CPU reference --------------------------------------------------------------- */

/* Locks of all ages, with matching lumas or others; depths of all kinds. */
static void fill_states(struct test_passes *test, double most, uint64_t *seed)
{
    static const float left[] = {0.0f, 0.01f, 0.5f, 1.0f, -1.0f, 2.0f, NAN};
    for (size_t i = 0; i < test_elements(test, RT_TAA_STATE_BEFORE); i++)
        test_set(test, RT_TAA_STATE_BEFORE, i,
                 (float[4]){left[neph_test_random(seed) % 7],
                            (float)neph_test_uniform(seed, 0.0, 4.0 * most), random_depth_m(seed)});
}

static void test_the_pass_equals_the_cpu_reference(void **state)
{
    static const int sizes_px[][2] = {{1, 1}, {5, 4}, {64, 36}, {67, 33}};
    static const char *const words[] = {"screen_percent=50 taa_age_max=8",
                                        "screen_percent=67 taa_age_max=1 taa_responsive=medium",
                                        "screen_percent=77 taa_age_max=32 taa_space=linear",
                                        "screen_percent=100 taa_age_max=8 taa_responsive=medium"};
    uint64_t seed = 20261126;
    for (int round = 0; round < neph_test_by_day(16, 64); round++) {
        const uint64_t start = seed;
        char text[1024];
        random_settings(&seed, text, 768);
        const size_t length = strlen(text);
        snprintf(text + length, sizeof(text) - length, "taa=locks %s taa_motion=%s",
                 words[round % 4], round % 3 ? "square" : "cross");
        const struct neph_settings settings = test_settings(text);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[round / 4 % 4], (int[2]){0, 0}, start, &test);
        const double most = round % 3 ? 1.0 : 100.0;
        test.view.frame = (uint32_t)neph_test_random(&seed);
        test.view.has_history = round % 8 != 7;
        test.view.jitter_px[0] = (float)neph_test_uniform(&seed, -0.5, 0.5);
        test.view.jitter_px[1] = (float)neph_test_uniform(&seed, -0.5, 0.5);
        if (round % 2)
            move_camera(&test.view, 0.02, 2.0, &seed);
        fill_depths(&test, &seed);
        fill_colours(&test, RT_COLOR, most, &seed);
        fill_colours(&test, RT_TAA_BEFORE, most, &seed);
        fill_medium(&test, &seed);
        fill_states(&test, most, &seed);
        for (size_t e = 0; e < test_elements(&test, RT_COLOR) && round % 5 == 4; e += 7)
            test_set(&test, RT_COLOR, e, (float[4]){NAN, 1.0f, INFINITY});
        test_passes_run(&test, "locks");
        cpu_locks(&test.cpu);
        if (settings.values[RT_TAA_GUARD] != 0.0 || round % 5 != 4) {
            compare(&test, most, start, text);
            test_same_words(&test, RT_TAA_STATE, start);
        }
    }
}

/* --- its parts -------------------------------------------------------------------------------- */

/* 32x16 pixels at 128 m, all with the colour `value`, no jitter. */
static void open_flat(struct neph_vulkan *vulkan, const char *words, float value,
                      struct test_passes *test)
{
    test_open(vulkan, 32, 16, 0, test,
              "taa=locks taa_box=none taa_hdr_weight=off target_format=float taa_age_max=8 %s",
              words);
    test_fill(test, RT_DEPTH, 128, 0, 0, 0);
    test_fill(test, RT_COLOR, value, value, value, 0);
    test_fill(test, RT_TAA_STATE_BEFORE, 0, 0, 128, 0);
}

/* The Lanczos kernel is 1 at its texel and 0 at all others: at 100 % and without jitter the output
 * is the frame. */
static void test_first_frame_is_unchanged(void **state)
{
    OWNED(passes) struct test_passes test;
    uint64_t seed = 3;
    open_flat(*state, "", 0.0f, &test);
    fill_colours(&test, RT_COLOR, 1.0, &seed);
    run(&test);
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 32; x++)
            for (int c = 0; c < 3; c++)
                neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, y, c),
                                  pixel_value(&test, RT_COLOR, x, y, c), 0.0, 1e-6);
}

/* Frames are averaged until the history has the weight of eight, then each has a weight of 1/9. */
static void test_history_weight_follows_its_colours(void **state)
{
    static const float frames[] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8};
    OWNED(passes) struct test_passes test;
    open_flat(*state, "", 0.0f, &test);
    double mean = 0.0;
    for (int n = 0; n < 12; n++) {
        test.view.has_history = n > 0;
        test_fill(&test, RT_COLOR, frames[n], frames[n], frames[n], 0);
        run(&test);
        mean += (frames[n] - mean) / (n < 8 ? n + 1 : 9);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 9, 9, 1), mean, 0.0, 1e-5);
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, 9, 9, 3), n < 8 ? n + 1 : 8, 0.0, 1e-5);
        test_swap(&test, RT_TAA_BEFORE, RT_TAA_OUT);
    }
}

/* A line of one rendered pixel is locked where its ray passed, at half the size in two of its four
 * output columns; an edge and a flat wall are not. A lock starts at full strength and loses 1 /
 * (length of the jitter) in each frame that does not renew it. */
static void test_thin_features_are_locked(void **state)
{
    static const struct {
        int first, end; /* lit columns */
        bool is_locked;
    } cases[] = {{7, 8, true}, {7, 16, false}, {0, 0, false}};
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        open_flat(*state, "screen_percent=50 taa_jitter_length=8", 0.1f, &test);
        for (int y = 0; y < 8; y++)
            for (int x = cases[i].first; x < cases[i].end; x++)
                cpu_put_full(&test.cpu, RT_COLOR, x, y, (float[4]){1.0f, 1.0f, 1.0f});
        run(&test);
        for (int y = 0; y < 16; y++)
            for (int x = 0; x < 32; x++)
                assert_true(pixel_value(&test, RT_TAA_STATE, x, y, 0) ==
                            (cases[i].is_locked && x / 2 == 7 ? 1.0 : 0.0));
    }
    OWNED(passes) struct test_passes test;
    open_flat(*state, "screen_percent=50 taa_jitter_length=8", 0.1f, &test);
    test.view.has_history = 1;
    for (size_t e = 0; e < test_elements(&test, RT_TAA_STATE_BEFORE); e++)
        test_set(&test, RT_TAA_STATE_BEFORE, e,
                 (float[4]){0.5f, e % 2 ? 0.4f : 0.6f, 128.0f}); /* the wall's luma, or another */
    run(&test);
    neph_assert_close(pixel_value(&test, RT_TAA_STATE, 5, 5, 0), 0.5 - 1.0 / 32.0, 0.0, 1e-6);
    assert_true(pixel_value(&test, RT_TAA_STATE, 6, 5, 0) == 0.0);
}

/* A lock keeps its share of the history out of the box, which here is the box of a flat frame. */
static void test_a_lock_keeps_the_history(void **state)
{
    OWNED(passes) struct test_passes test;
    open_flat(*state, "taa_box=min_max taa_jitter_length=64", 1.0f, &test);
    test.view.has_history = 1;
    for (size_t e = 0; e < test_elements(&test, RT_TAA_BEFORE); e++) {
        test_set(&test, RT_TAA_BEFORE, e, (float[4]){3.0f, 3.0f, 3.0f, 7.0f});
        test_set(&test, RT_TAA_STATE_BEFORE, e,
                 (float[4]){0.515625f, e % 2 ? 4.0f : 9.0f, 128.0f}); /* half remains */
    }
    run(&test);
    neph_assert_close(pixel_value(&test, RT_TAA_OUT, 5, 5, 0), 1.0 + 7.0 / 8.0, 0.0, 1e-5);
    neph_assert_close(pixel_value(&test, RT_TAA_OUT, 6, 5, 0), 1.0, 0.0, 1e-5);
}

/* A surface that was nearer by more than 2 % leaves no valid history, except within two pixels of a
 * surface that is still as near. */
static void test_disoccluded_pixels_have_no_history(void **state)
{
    OWNED(passes) struct test_passes test;
    open_flat(*state, "", 1.0f, &test);
    test.view.has_history = 1;
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 32; x++) {
            const float before_m = x < 16 ? 120.0f : 126.0f; /* of 128: 6 % and 1.6 % nearer */
            cpu_put_full(&test.cpu, RT_DEPTH, x, y, (float[4]){x == 0 ? 120.0f : 128.0f});
            cpu_put_output(&test.cpu, RT_TAA_STATE_BEFORE, x, y, (float[4]){0.0f, 0.0f, before_m});
            cpu_put_output(&test.cpu, RT_TAA_BEFORE, x, y, (float[4]){3.0f, 3.0f, 3.0f, 3.0f});
        }
    run(&test);
    for (int x = 0; x < 32; x++) /* pixel 15 has a neighbour at 126 m */
        neph_assert_close(pixel_value(&test, RT_TAA_OUT, x, 8, 0), x < 3 || x > 14 ? 2.5 : 1.0, 0.0,
                          1e-5);
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * What anti-aliasing and upsampling can be told of the frame: which pixels are of media without
 * motion vectors, and that the camera's exposure has changed. One frame in closed form each, in
 * both passes.
 */
#include "renderer/realtime/anti_aliasing/check_taa.h"

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

static void run(struct test_passes *test, int p)
{
    test_passes_run(test, passes[p].pass);
    test_take(test, RT_TAA_OUT);
}

/* Where more than half of the light is of the medium the frame weighs a quarter, unless it weighs
 * more anyhow. */
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
            struct test_passes test;
            open_plain(*state, p, cases[i].words, &test);
            test_fill(&test, RT_VOLUME, 0, 0, 0, cases[i].through);
            run(&test, p);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 7, 3, 1), 1.0 + cases[i].weight, 0.0,
                              1e-6);
            test_passes_close(&test);
        }
}

/* Light of 2 and a history of 1 that was kept at half the exposure. Both are kept exposed; the
 * history by the exposure of its own frame unless it is told. */
static void test_history_follows_the_exposure(void **state)
{
    static const struct {
        const char *words;
        double kept;
    } cases[] = {{"taa_pre_exposure=off", 0.875 * 0.5 + 0.125 * 16.0},
                 {"taa_pre_exposure=on", 0.875 * 8.0 + 0.125 * 16.0}};
    for (int p = 0; p < 2; p++)
        for (int i = 0; i < 2; i++) {
            struct test_passes test;
            open_plain(*state, p, cases[i].words, &test);
            test.view.exposure = 8.0f;
            test.view.exposure_before = 0.5f;
            test_fill(&test, RT_TAA_BEFORE, 0.5f, 0.5f, 0.5f, 0);
            run(&test, p);
            neph_assert_close(pixel_value(&test, RT_TAA_OUT, 7, 3, 2), cases[i].kept, 1e-6, 0.0);
            test_passes_close(&test);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_media_are_responsive),
        cmocka_unit_test(test_history_follows_the_exposure),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}

/* SPDX-License-Identifier: MIT
 *
 * Tests of sharpening: the shader against its formula, constants, and edges.
 */
#include "tests/renderer/realtime_test.h"

static void get_rgb(const struct test_passes *test, int target, int x, int y, float rgb[4])
{
    const int right = (int)test->view.size_px[0] - 1, bottom = (int)test->view.size_px[1] - 1;
    x = x < 0 ? 0 : x > right ? right : x;
    y = y < 0 ? 0 : y > bottom ? bottom : y;
    cpu_fetch_full(&test->cpu, target, x, y, rgb);
}

/* The pixel moves away from the mean of its neighbours, within the range of the five. */
static void sharpen(struct test_passes *test, int source, int x, int y)
{
    static const int cross[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    float own[4], neighbours[4][4], made[4] = {0};
    get_rgb(test, source, x, y, own);
    for (int i = 0; i < 4; i++)
        get_rgb(test, source, x + cross[i][0], y + cross[i][1], neighbours[i]);
    for (int c = 0; c < 3; c++) {
        float sum = 0.0f, least = own[c], largest = own[c];
        for (int i = 0; i < 4; i++) {
            sum += neighbours[i][c];
            least = fminf(least, neighbours[i][c]);
            largest = fmaxf(largest, neighbours[i][c]);
        }
        made[c] = fmaxf(fminf(own[c] + 0.5f * (own[c] - 0.25f * sum), largest), least);
    }
    cpu_put_full(&test->cpu, RT_SHARPENED, x, y, made);
}

static void test_the_shader_is_its_formula(void **state)
{
    static const struct {
        const char *settings;
        int source;
    } cases[] = {{"sharpen=on", RT_TAA_OUT},
                 {"sharpen=on taa=off", RT_COLOR},
                 {"sharpen=on target_format=float", RT_TAA_OUT}};
    for (size_t k = 0; k < COUNT(cases); k++) {
        const struct neph_settings settings = test_settings(cases[k].settings);
        OWNED(passes) struct test_passes test;
        uint64_t seed = 20261123 + k;
        test_passes_open(*state, &settings, (int[2]){37, 21}, (int[2]){4, 8}, seed, &test);
        for (size_t i = 0; i < test_elements(&test, cases[k].source); i++) {
            const float step = i % 5 ? 1.0f : 100.0f;
            test_set(&test, cases[k].source, i,
                     (float[4]){step * (float)test_uniform(&seed), step, (float)(i % 3)});
        }
        test_passes_run(&test, "sharpening");
        for (int y = 0; y < 21; y++)
            for (int x = 0; x < 37; x++)
                sharpen(&test, cases[k].source, x, y);
        test_same_words(&test, RT_SHARPENED, seed);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_the_shader_is_its_formula)};
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}

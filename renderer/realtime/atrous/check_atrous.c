/* SPDX-License-Identifier: MIT
 *
 * Tests of the a-trous filter of the volume: its steps against their CPU reference, edges, the
 * reduction of noise, and that the upscale reads its output.
 */
#include "tests/renderer/realtime_test.h"

static const char *const names[] = {"a-trous 1", "a-trous 2", "a-trous 4"};
static const int inputs[] = {RT_HISTORY, RT_HISTORY_BEFORE, RT_KEPT_RAY};
static const int outputs[] = {RT_HISTORY_BEFORE, RT_KEPT_RAY, RT_HISTORY_BEFORE};

static void open_volume(struct neph_vulkan *vulkan, const char *words, const int size_px[2],
                        uint64_t seed, struct test_passes *test)
{
    char text[256];
    snprintf(text, sizeof(text), "atrous=on %s", words);
    const struct neph_settings settings = test_settings(text);
    test_passes_open(vulkan, &settings, size_px, (int[2]){4, 8}, seed, test);
    test_fill(test, RT_HALF_DEPTH, 100, 0, 0, 0);
    test_fill(test, RT_HISTORY_STATE, 1, 50, 0, 0);
}

/* Rounding of about 75 sums, of exp() to 3 ulps times the weight's exponent, and of halves. */
static void test_each_step_equals_the_cpu_reference(void **state)
{
    static const int sizes_px[][2] = {{1, 1}, {9, 5}, {64, 36}};
    uint64_t seed = 11;
    for (int round = 0; round < 9; round++) {
        const int step = round % 3;
        OWNED(passes) struct test_passes test;
        open_volume(*state, round % 2 ? "target_format=float" : "", sizes_px[round / 3], seed,
                    &test);
        for (size_t i = 0; i < test_elements(&test, RT_HISTORY); i++) {
            float volume[4];
            for (int c = 0; c < 4; c++)
                volume[c] = (float)test_uniform(&seed);
            if (neph_test_random(&seed) % 16 == 0)
                volume[neph_test_random(&seed) % 4] = neph_test_random(&seed) % 2 ? NAN : -1.0f;
            test_set(&test, inputs[step], i, volume);
            test_set(&test, RT_HALF_DEPTH, i,
                     (float[4]){neph_test_random(&seed) % 4
                                    ? 100.0f + (float)(neph_test_random(&seed) % 9)
                                    : NEPH_GPU_FAR_M});
            if (neph_test_random(&seed) % 16 == 0)
                test_set(&test, RT_HISTORY_STATE, i, (float[4]){0.0f});
        }
        test_passes_run(&test, names[step]);
        cpu_atrous(&test.cpu, 1 << step);
        OWNED(memory) uint32_t *words = test_download(&test, outputs[step]);
        for (size_t i = 0; i < test_elements(&test, outputs[step]); i++) {
            float actual[4], expected[4];
            neph_rt_load(&test.view.targets[outputs[step]], words, i, actual);
            test_get(&test, outputs[step], i, expected);
            for (int c = 0; c < 4; c++)
                if (!(isnan(actual[c]) && isnan(expected[c])))
                    neph_assert_close(actual[c], expected[c], 0x1p-10, 1e-5);
        }
    }
}

static double deviation(struct test_passes *test, int target, double mean)
{
    OWNED(memory) uint32_t *words = test_download(test, target);
    double squares = 0.0;
    int count = 0;
    for (int y = 8; y < 56; y++) /* away from the sides */
        for (int x = 8; x < 56; x++, count++) {
            float value[4];
            neph_rt_load(&test->view.targets[target], words,
                         (size_t)(y + 4) * test->view.targets[target].width + (size_t)(x + 2),
                         value);
            squares += pow((double)value[3] - mean, 2.0);
        }
    return sqrt(squares / count);
}

/* White noise of transmittance with constant luma: a step reduces its deviation to the root of the
 * sum of the squared weights, 70 / 256. The deviation of 2304 texels is exact to 1 / sqrt(2 2304),
 * 1.5 %, and less exact because neighbours are correlated: 5 %. */
static void test_noise_is_averaged_by_what_the_spline_says(void **state)
{
    uint64_t seed = 5;
    OWNED(passes) struct test_passes test;
    open_volume(*state, "target_format=float", (int[2]){128, 128}, 2, &test);
    for (size_t i = 0; i < test_elements(&test, RT_HISTORY); i++) {
        const float value = (float)(0.5 + 0.1 * (test_uniform(&seed) - 0.5));
        test_set(&test, RT_HISTORY, i, (float[4]){1.0f, 1.0f, 1.0f, value});
    }
    test_passes_run(&test, names[0]);
    neph_assert_close(deviation(&test, RT_HISTORY_BEFORE, 0.5), 0.1 / sqrt(12.0) * 70.0 / 256.0,
                      0.05, 0.0);
}

/* A constant stays constant; no light crosses an edge of depth. */
static void test_edges_stay(void **state)
{
    static const struct {
        float near_m, left, right;
    } cases[] = {{100.0f, 0.5f, 0.5f}, {10.0f, 0.25f, 0.75f}};
    for (int i = 0; i < 2; i++) {
        OWNED(passes) struct test_passes test;
        open_volume(*state, "", (int[2]){64, 32}, 0, &test);
        for (int y = 0; y < 16; y++)
            for (int x = 0; x < 32; x++) {
                const float value = x < 16 ? cases[i].left : cases[i].right;
                cpu_put_half(&test.cpu, RT_HISTORY, x, y, (float[4]){value, value, value, value});
                cpu_put_half(&test.cpu, RT_HALF_DEPTH, x, y,
                             (float[4]){x < 16 ? cases[i].near_m : 100.0f});
            }
        test_passes_run(&test, names[0]);
        uint32_t *words = test_download(&test, RT_HISTORY_BEFORE);
        memcpy(test.cpu.targets[RT_HISTORY_BEFORE], words,
               neph_rt_device_words(&test.device, RT_HISTORY_BEFORE) * sizeof(*words));
        free(words);
        for (int x = 0; x < 32; x++) {
            float value[4];
            cpu_fetch_half(&test.cpu, RT_HISTORY_BEFORE, x, 8, value);
            neph_assert_close(value[3], x < 16 ? cases[i].left : cases[i].right, 0.0, 2e-3);
        }
    }
}

static void test_upscale_reads_filtered_volume(void **state)
{
    OWNED(passes) struct test_passes test;
    open_volume(*state, "upscale=bilinear upscale_dither=none", (int[2]){32, 16}, 0, &test);
    test_fill(&test, RT_HISTORY, 1, 1, 1, 0.25f);
    test_fill(&test, RT_HISTORY_BEFORE, 2, 2, 2, 0.5f);
    test_fill(&test, RT_DEPTH, 100, 0, 0, 0);
    test_passes_run(&test, "upscale");
    uint32_t *words = test_download(&test, RT_VOLUME);
    float value[4];
    neph_rt_load(&test.view.targets[RT_VOLUME], words,
                 (size_t)16 * test.view.targets[RT_VOLUME].width + 12, value);
    free(words);
    assert_true(value[0] == 2.0f && value[3] == 0.5f);
}

#include "tests/renderer/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Tests of the composition: exact identities, and equality of its two implementations.
 */
#include "tests/renderer/realtime_test.h"

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};

/* A view away from the corner of its targets, in both formats of a target. */
static void open_view(void **state, const char *assignments, const int size_px[2], uint64_t seed,
                      struct test_passes *test)
{
    const struct neph_settings settings = test_settings(assignments);
    test_passes_open(*state, &settings, size_px, (int[2]){4, 8}, seed, test);
}

static void compose_both(struct test_passes *test)
{
    test_passes_run(test, "composition");
    cpu_compose(&test->cpu);
}

/* 0, and 1e-6 .. 1e6 on a logarithmic scale. */
static float random_radiance(uint64_t *seed)
{
    return neph_test_random(seed) % 8 ? (float)pow(10.0, 12.0 * test_uniform(seed) - 6.0) : 0.0f;
}

/* The shader multiplies, rounds, adds and rounds, as C does: with the single rounding of a fused
 * multiply-add one value in nine would differ. */
static void test_compose_equals_the_cpu_reference(void **state)
{
    uint64_t seed = 20261126;
    for (size_t s = 0; s < COUNT(sizes_px); s++)
        for (int f = 0; f < 2; f++) {
            const uint64_t start = seed;
            OWNED(passes) struct test_passes test;
            open_view(state, f ? "target_format=float" : "target_format=half", sizes_px[s], seed,
                      &test);
            for (size_t i = 0; i < test_elements(&test, RT_VOLUME); i++) {
                test_set(&test, RT_VOLUME, i,
                         (float[4]){random_radiance(&seed), random_radiance(&seed),
                                    random_radiance(&seed), (float)test_uniform(&seed)});
                test_set(&test, RT_BEHIND, i,
                         (float[4]){random_radiance(&seed), random_radiance(&seed),
                                    random_radiance(&seed)});
            }
            compose_both(&test);
            test_same_words(&test, RT_COLOR, start);
        }
}

/* Without a volume the background is unchanged, bit by bit; behind an opaque volume only the volume
 * is visible; a T that is a power of 2 scales the background exactly. */
static void test_identities(void **state)
{
    static const struct {
        float volume[4];
        float behind_weight, volume_weight;
    } cases[] = {
        {{0, 0, 0, 1}, 1, 0},
        {{3.25f, 1e-3f, 6e4f, 0}, 0, 1},
        {{0, 0, 0, 0.25f}, 0.25f, 0},
    };
    uint64_t seed = 7;
    for (size_t k = 0; k < COUNT(cases); k++) {
        OWNED(passes) struct test_passes test;
        open_view(state, "target_format=float", sizes_px[4], seed, &test);
        for (size_t i = 0; i < test_elements(&test, RT_VOLUME); i++) {
            test_set(&test, RT_VOLUME, i, cases[k].volume);
            test_set(&test, RT_BEHIND, i,
                     (float[4]){random_radiance(&seed), random_radiance(&seed), 1e30f});
        }
        compose_both(&test);
        test_same_words(&test, RT_COLOR, seed);
        for (uint32_t y = 0; y < test.view.size_px[1]; y++)
            for (uint32_t x = 0; x < test.view.size_px[0]; x++) {
                float color[4], behind[4];
                cpu_fetch_full(&test.cpu, RT_COLOR, (int)x, (int)y, color);
                cpu_fetch_full(&test.cpu, RT_BEHIND, (int)x, (int)y, behind);
                for (int c = 0; c < 3; c++)
                    assert_true(color[c] == cases[k].behind_weight * behind[c] +
                                                cases[k].volume_weight * cases[k].volume[c]);
            }
    }
}

/* Texels outside the view are not written. */
static void test_texels_outside_view_are_unchanged(void **state)
{
    OWNED(passes) struct test_passes test;
    open_view(state, "", sizes_px[2], 1, &test);
    const float mark[4] = {-1, -2, -3, -4};
    for (size_t i = 0; i < test_elements(&test, RT_COLOR); i++)
        test_set(&test, RT_COLOR, i, mark);
    compose_both(&test);
    test_same_words(&test, RT_COLOR, 1);
    int written = 0;
    for (size_t i = 0; i < test_elements(&test, RT_COLOR); i++) {
        float color[4];
        test_get(&test, RT_COLOR, i, color);
        written += color[0] != mark[0];
    }
    assert_int_equal(written, sizes_px[2][0] * sizes_px[2][1]);
}

/* Output of the anti-aliasing from a volume and a background; the caller frees it. */
static uint32_t *anti_aliased(struct test_passes *test, int composition)
{
    test->view.settings[RT_COMPOSITION] = (float)composition;
    test_passes_run(test, "anti-aliasing");
    return test_download(test, RT_TAA_OUT);
}

/* The same bits where the anti-aliasing composes, for any contents of the unused target, in the
 * kernels of a CPU and of a GPU. */
static void test_the_anti_aliasing_composes_as_the_pass_does(void **state)
{
    static const char *const settings[] = {
        "", "taa_box=variance", "taa_box=variance taa_guard=off taa_filter=off taa_hdr_weight=off"};
    for (uint64_t i = 0; i < 2 * COUNT(settings); i++) {
        uint64_t seed = i;
        OWNED(passes) struct test_passes test;
        open_view(state, settings[i / 2], sizes_px[4], seed, &test);
        test.view.has_history = 1;
        test.view.jitter_px[0] = 0.25f;
        for (size_t e = 0; e < test_elements(&test, RT_VOLUME); e++) {
            const float behind = random_radiance(&seed), volume = random_radiance(&seed);
            test_set(&test, RT_BEHIND, e, (float[4]){behind, 0.5f * behind, 2.0f});
            test_set(&test, RT_VOLUME, e,
                     (float[4]){volume, 1.0f, 0.3f * volume, (float)test_uniform(&seed)});
            test_set(&test, RT_TAA_BEFORE, e, (float[4]){behind, volume, 1.0f, 1.0f});
        }
        compose_both(&test);
        OWNED(memory) uint32_t *by_pass = anti_aliased(&test, RT_COMPOSITION_PASS);
        test_fill(&test, RT_COLOR, NAN, NAN, NAN, NAN);
        OWNED(memory) uint32_t *by_itself = anti_aliased(&test, RT_COMPOSITION_TAA);
        assert_memory_equal(by_pass, by_itself,
                            neph_rt_device_words(&test.device, RT_TAA_OUT) * sizeof(uint32_t));
    }
}

/* The composed frame after the upscale; the caller frees it. */
static uint32_t *upscaled(struct test_passes *test, int composition)
{
    test->view.settings[RT_COMPOSITION] = (float)composition;
    test_passes_run(test, "upscale");
    if (composition == RT_COMPOSITION_PASS) {
        test_take(test, RT_VOLUME);
        test_passes_run(test, "composition");
    }
    return test_download(test, RT_COLOR);
}

/* The same bits where the upscale composes, in each format of the volume, and in kernels with and
 * without constant settings. */
static void test_the_upscale_composes_as_the_pass_does(void **state)
{
    static const char *const settings[] = {"target_format=half", "target_format=float"};
    for (uint64_t i = 0; i < 4; i++) {
        uint64_t seed = i;
        OWNED(passes) struct test_passes test;
        open_view(state, settings[i / 2], sizes_px[i + 1], seed, &test);
        test.device.specialises = i % 2;
        for (size_t e = 0; e < test_elements(&test, RT_HISTORY); e++) {
            test_set(
                &test, RT_HISTORY, e,
                (float[4]){random_radiance(&seed), 1.0f / 3.0f, 7.0f, (float)test_uniform(&seed)});
            test_set(&test, RT_HISTORY_STATE, e, (float[4]){(float)(e % 3), 12.0f});
            test_set(&test, RT_HALF_DEPTH, e, (float[4]){10.0f});
        }
        for (size_t e = 0; e < test_elements(&test, RT_DEPTH); e++) {
            test_set(&test, RT_DEPTH, e, (float[4]){10.0f + (float)(e % 3)});
            test_set(&test, RT_BEHIND, e, (float[4]){random_radiance(&seed), 0.1f, 1.0f / 7.0f});
        }
        OWNED(memory) uint32_t *by_pass = upscaled(&test, RT_COMPOSITION_PASS);
        test_fill(&test, RT_COLOR, 0, 0, 0, 0);
        OWNED(memory) uint32_t *by_itself = upscaled(&test, RT_COMPOSITION_UPSCALE);
        const size_t bytes = neph_rt_device_words(&test.device, RT_COLOR) * sizeof(uint32_t);
        assert_memory_equal(by_pass, by_itself, bytes);
    }
}

#include "tests/renderer/main.h"

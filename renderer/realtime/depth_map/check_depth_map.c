/* SPDX-License-Identifier: MIT
 *
 * Tests of the formats of targets, and of the depth map at half resolution.
 */
#include "tests/renderer/realtime_test.h"

#include "base/half.h"

static void test_every_half_comes_back(void **state)
{
    for (uint32_t half = 0; half < 0x10000u; half++) {
        const float value = neph_half_to_float((uint16_t)half);
        if (isnan(value))
            assert_true((half & 0x7c00u) == 0x7c00u && (half & 0x3ffu) != 0);
        else
            assert_int_equal(neph_rt_to_half(value), half);
    }
}

/* Against the compiler's own conversion, which rounds as IEEE 754 defines. */
static void test_halves_round_to_nearest_even(void **state)
{
    uint64_t seed = 20261121;
    for (int i = 0; i < 2000000; i++) {
        const uint32_t bits = (uint32_t)neph_test_random(&seed);
        float value;
        memcpy(&value, &bits, sizeof(value));
        if (i % 2)
            value = ldexpf((float)(test_uniform(&seed) - 0.5),
                           (int)(neph_test_random(&seed) % 44) - 26);
        if (isnan(value))
            continue;
        const _Float16 expected = (_Float16)value;
        uint16_t expected_bits;
        memcpy(&expected_bits, &expected, sizeof(expected_bits));
        if (neph_rt_to_half(value) != expected_bits)
            fail_msg("%a became %04x, not %04x", (double)value, neph_rt_to_half(value),
                     expected_bits);
    }
}

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};

/* Near, far, sky, equal: all kinds of depths. */
static float random_depth_m(uint64_t *seed)
{
    switch (neph_test_random(seed) % 4) {
    case 0:
        return NEPH_GPU_FAR_M;
    case 1:
        return 10.0f;
    default:
        return (float)exp(14.0 * test_uniform(seed));
    }
}

static void test_min_max_equals_the_cpu_reference(void **state)
{
    static const char *const maps[] = {"depth_map=checkerboard", "depth_map=nearest",
                                       "depth_map=farthest", "depth_map=reversed"};
    uint64_t seed = 1;
    for (size_t s = 0; s < COUNT(sizes_px); s++)
        for (int m = 0; m < 4; m++) {
            const uint64_t start = seed;
            const struct neph_settings settings = test_settings(maps[m]);
            OWNED(passes) struct test_passes test;
            const int origin_px[2] = {m == 1 ? 8 : 0, m == 1 ? 4 : 0};
            test_passes_open(*state, &settings, sizes_px[s], origin_px, seed, &test);
            for (size_t i = 0; i < test_elements(&test, RT_STEADY_DEPTH); i++)
                test_set(&test, RT_STEADY_DEPTH, i, (float[4]){random_depth_m(&seed)});
            test_passes_run(&test, "depth map");
            cpu_min_max(&test.cpu);
            test_same_words(&test, RT_HALF_DEPTH, start);
        }
}

/* Each tile has two nearest and two farthest depths of its 4x4 pixels. */
static void test_a_tile_has_two_near_and_two_far(void **state)
{
    const struct neph_settings settings = test_settings("depth_map=checkerboard");
    static const float near_m = 10.0f, far_m = 1000.0f;
    struct neph_gpu_view view;
    neph_rt_view_init(&view, &settings, (int[2]){8, 8}, (int[2]){0, 0}, (int[2]){8, 8});
    uint32_t depth[64], half[16];
    const struct reference cpu = {.view = &view,
                                  .targets = {[RT_STEADY_DEPTH] = depth, [RT_HALF_DEPTH] = half}};
    for (size_t i = 0; i < 64; i++)
        neph_rt_store(&view.targets[RT_STEADY_DEPTH], depth, i, (float[4]){i % 2 ? near_m : far_m});
    cpu_min_max(&cpu);
    for (int tile = 0; tile < 4; tile++) {
        int near_count = 0;
        for (int slot = 0; slot < 4; slot++) {
            float value[4];
            cpu_fetch_half(&cpu, RT_HALF_DEPTH, tile % 2 * 2 + slot % 2, tile / 2 * 2 + slot / 2,
                           value);
            near_count += value[0] == near_m;
        }
        assert_int_equal(near_count, 2);
    }
}

#include "tests/renderer/main.h"

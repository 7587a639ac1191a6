/* SPDX-License-Identifier: MIT
 *
 * Shader variants for a kind of device compared with the readable shader of the same pass, on the
 * same random targets.
 */
#include "tests/renderer/realtime_test.h"

#include <math.h>

/* Half a step of half precision: both round the same sum, with float32 terms in another order. */
static const double half_step = 0x1p-10;

/* Passes with results that may be rounded differently, and the difference of their sums for values
 * up to 1, before rounding to half precision. All other passes have the same bits. The upscale
 * interpolates, which loses no digits. The anti-aliasing has errors of up to 16 ulps, and 100 times
 * as much where the contrast law applies (allowed() in anti_aliasing/check_taa.h). */
static const struct {
    const char *pass;
    double error;
} free_passes[] = {{"upscale", 0.0}, {"anti-aliasing", 100.0 * 16.0 * 0x1p-24}};

/* The first is for passes that may be rounded differently. */
static const int sizes_px[][2] = {{61, 35}, {1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}};

static int free_pass(const char *name)
{
    for (size_t i = 0; i < COUNT(free_passes); i++)
        if (!strcmp(free_passes[i].pass, name))
            return (int)i;
    return -1;
}

static float pick_depth_m(uint64_t *seed)
{
    static const float depths_m[] = {10, 10, 100, 160, 125, 1000, 15000, 30000, NEPH_GPU_FAR_M};
    return depths_m[neph_test_random(seed) % COUNT(depths_m)];
}

static void fill_at_random(struct test_passes *test, int target, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, target); i++) {
        float value[4];
        for (int c = 0; c < 4; c++)
            value[c] = (float)test_uniform(seed);
        if (target == RT_DEPTH || target == RT_STEADY_DEPTH || target == RT_HALF_DEPTH ||
            target == RT_HALF_DEPTH_BEFORE)
            value[0] = pick_depth_m(seed);
        if (target == RT_TILE) {
            value[0] = (float)(neph_test_random(seed) % 4);
            value[1] = fminf(pick_depth_m(seed), 20000.0f) * 1e-4f;
        }
        if (target == RT_HISTORY_STATE || target == RT_HISTORY_STATE_BEFORE) {
            value[0] = (float)(1 + neph_test_random(seed) % 9);
            value[1] = 1000.0f * value[1];
        }
        if (target == RT_RAY_DISTANCE || target == RT_VOLUME_DISTANCE)
            value[0] *= 1000.0f;
        if (target == RT_SAMPLE_THEN || target == RT_SAMPLE_BEHIND_THEN)
            value[3] = (float)(neph_test_random(seed) % 2);
        test_set(test, target, i, value);
    }
}

/* The targets that the pass, and the pass that its variant absorbs, write, after both. The caller
 * frees them. */
static void take_results(struct test_passes *test, uint32_t targets, uint32_t *results[])
{
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        results[t] = targets & NEPH_RT_BIT(t) ? test_download(test, t) : NULL;
}

static void run_readable(struct test_passes *test, const struct neph_rt_pass *pass,
                         const struct neph_rt_pass *absorbed)
{
    uint32_t *before[RT_TARGET_COUNT] = {NULL};
    test->device.has_no_variants = true;
    neph_rt_absorb_passes(&test->view, test->device.kind, false);
    if (absorbed) {
        test_passes_run(test, absorbed->name);
        for (int t = 0; t < RT_TARGET_COUNT; t++)
            if (absorbed->writes & NEPH_RT_BIT(t)) {
                before[t] = test->cpu.targets[t];
                test->cpu.targets[t] = test_download(test, t);
            }
    }
    test_passes_run(test, pass->name);
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        if (before[t]) {
            free(test->cpu.targets[t]);
            test->cpu.targets[t] = before[t];
        }
    test->device.has_no_variants = false;
}

static bool are_close(const float a[4], const float b[4], double step, double error)
{
    for (int c = 0; c < 4; c++)
        if (!(a[c] == b[c] || fabs((double)a[c] - b[c]) <= step * fabs((double)b[c]) + error))
            return false;
    return true;
}

static void compare(struct test_passes *test, const struct neph_rt_pass *pass, int target,
                    const uint32_t *readable, const uint32_t *variant, const char *preset)
{
    const int row = free_pass(pass->name);
    const double step = row < 0 ? 0.0 : half_step, error = row < 0 ? 0.0 : free_passes[row].error;
    const size_t count = test_elements(test, target);
    size_t apart = 0;
    for (size_t i = 0; i < count; i++) {
        float a[4], b[4];
        neph_rt_load(&test->view.targets[target], variant, i, a);
        neph_rt_load(&test->view.targets[target], readable, i, b);
        apart += !are_close(a, b, step, error);
    }
    if (apart > 0)
        fail_msg("%s of preset %s on kind %d: %zu of %zu elements of %s differ", pass->name, preset,
                 (int)test->device.kind, apart, count, neph_rt_target_name(target));
}

/* With a moving or a static camera. */
static void compare_pass(struct neph_vulkan *vulkan, const struct neph_rt_pass *pass, int kind,
                         int preset, uint64_t seed)
{
    const int size = free_pass(pass->name) < 0 ? (2 * preset + (int)seed) % 6 : 0;
    const struct neph_settings settings = test_settings(neph_rt_presets[preset].assignments);
    uint32_t *readable[RT_TARGET_COUNT], *variant[RT_TARGET_COUNT];
    OWNED(passes) struct test_passes test;
    test_passes_open(vulkan, &settings, sizes_px[size], (int[2]){8, 4}, 2 * seed, &test);
    if (kind == NEPH_RT_GPU)
        test_be_gpu(&test.device);
    const struct neph_rt_pass *absorbed = pass->variants[kind].absorbs;
    if (absorbed && !neph_rt_is_condition_met(&test.view, absorbed->condition))
        absorbed = NULL;
    test.view.frame = (uint32_t)seed;
    test.view.has_history = preset % 4 != 3;
    test.view.resting = preset % 5 == 4;
    if (seed % 2) {
        test.view.before.right[2] -= 0.01f;
        test.view.before.position_m[0] = 0.5f;
    }
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        fill_at_random(&test, t, &seed);
    const uint32_t targets = pass->writes | (absorbed ? absorbed->writes : 0u);
    if (neph_rt_is_condition_met(&test.view, pass->condition) &&
        neph_rt_shader_for(&test.view, pass, kind) != &pass->shader) {
        run_readable(&test, pass, absorbed);
        take_results(&test, targets, readable);
        neph_rt_absorb_passes(&test.view, kind, true);
        const uint32_t touched = neph_rt_targets_touched(&test.view, pass);
        test_passes_run(&test, pass->name);
        take_results(&test, targets, variant);
        for (int t = 0; t < RT_TARGET_COUNT; t++) {
            if (targets & touched & NEPH_RT_BIT(t))
                compare(&test, pass, t, readable[t], variant[t], neph_rt_presets[preset].name);
            free(readable[t]);
            free(variant[t]);
        }
    }
}

static void test_variants_equal_readable_shaders(void **state)
{
    for (int p = 0; neph_rt_passes[p]; p++)
        for (int kind = 0; kind < NEPH_RT_DEVICE_KINDS; kind++)
            for (int i = 0; neph_rt_passes[p]->variants[kind].code && neph_rt_presets[i].name; i++)
                for (uint64_t seed = 0; seed < 2; seed++)
                    compare_pass(*state, neph_rt_passes[p], kind, i, seed);
}

#include "tests/renderer/main.h"

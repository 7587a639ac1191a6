/* SPDX-License-Identifier: MIT
 *
 * Common part of the tests of single passes: the same random or adversarial targets for the device
 * and for the CPU reference, and a comparison of the results.
 */
#ifndef NEPH_TESTS_REALTIME_TEST_H
#define NEPH_TESTS_REALTIME_TEST_H

#include "tests/renderer/renderer_test.h"

#include "renderer/realtime/device.h"
#include "renderer/realtime/layout.h"
#include "renderer/realtime/options.h"
#include "renderer/realtime/shared/check_reference.h"

#include <stdlib.h>

/* Device and CPU reference. */
struct test_passes {
    struct neph_gpu_view view;
    struct neph_rt_device device;
    struct reference cpu;
    uint32_t noise_ranks[NEPH_RT_NOISE_COUNT]; /* random, below 4096 */
};

static inline double test_uniform(uint64_t *seed)
{
    return neph_test_uniform(seed, 0.0, 1.0);
}

/* Default settings with the article's sky distance of 20 km, changed by "key=value key=value". */
static inline struct neph_settings test_settings(const char *assignments)
{
    struct neph_settings settings = neph_options_default(neph_rt_options);
    settings.values[RT_SKY_M] = 20000.0;
    test_assign(neph_rt_options, assignments, &settings);
    return settings;
}

/* Compiles the passes as for a GPU. */
static inline void test_be_gpu(struct neph_rt_device *device)
{
    struct neph_diag diag = {0};
    device->kind = NEPH_RT_GPU;
    neph_assert_ok(neph_halves_test(device->vulkan, &device->native_halves, &diag), &diag);
}

/* Opens both sides for a view of the given size, at an origin in its buffers, with a camera of 50
 * degrees in both frames. The test changes cpu.view (the same as `view`) and the targets before
 * test_passes_run(). Odd seeds use the kernels of a GPU. */
static inline void test_passes_open(struct neph_vulkan *vulkan,
                                    const struct neph_settings *settings, const int size_px[2],
                                    const int origin_px[2], uint64_t seed, struct test_passes *test)
{
    memset(test, 0, sizeof(*test));
    const int buffer_px[2] = {origin_px[0] + size_px[0] + (int)(seed % 3) * 4,
                              origin_px[1] + size_px[1]};
    neph_rt_view_init(&test->view, settings, size_px, origin_px, buffer_px);
    const float tangent = 0.4663077f;
    test->view.now = (struct neph_gpu_view_camera){
        .right = {1, 0, 0},
        .half_width = tangent * (float)size_px[0] / (float)size_px[1],
        .up = {0, 1, 0},
        .half_height = tangent,
        .forward = {0, 0, -1},
    };
    test->view.before = test->view.now;
    test->view.seed = (uint32_t)seed;
    for (size_t i = 0; i < NEPH_RT_NOISE_COUNT; i++)
        test->noise_ranks[i] = (uint32_t)(neph_test_random(&seed) % 4096);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_rt_device_create(vulkan, &test->view, NEPH_RT_BIT(RT_TARGET_COUNT) - 1,
                                         test->noise_ranks, &test->device, &diag),
                   &diag);
    if (test->view.seed % 2)
        test_be_gpu(&test->device);
    test->cpu.view = &test->view;
    test->cpu.noise_ranks = test->noise_ranks;
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        test->cpu.targets[t] = calloc(neph_rt_device_words(&test->device, t), sizeof(uint32_t));
}

/* test_passes_open() with the origin at the first corner, and settings from test_settings(). */
static inline void test_open_words(struct neph_vulkan *vulkan, const int size_px[2], uint64_t seed,
                                   struct test_passes *test, const char *format, va_list arguments)
{
    char words[1024];
    assert_true(vsnprintf(words, sizeof(words), format, arguments) < (int)sizeof(words));
    const struct neph_settings settings = test_settings(words);
    test_passes_open(vulkan, &settings, size_px, (int[2]){0, 0}, seed, test);
}

__attribute__((format(printf, 6, 7))) static inline void
test_open(struct neph_vulkan *vulkan, int width_px, int height_px, uint64_t seed,
          struct test_passes *test, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    test_open_words(vulkan, (int[2]){width_px, height_px}, seed, test, format, arguments);
    va_end(arguments);
}

/* Makes the camera of both frames orthographic. */
static inline void test_make_parallel(struct neph_gpu_view *view, float half_height_m)
{
    struct neph_gpu_view_camera *const cameras[] = {&view->now, &view->before};
    for (int i = 0; i < 2; i++) {
        cameras[i]->is_parallel = 1;
        cameras[i]->half_height = half_height_m;
        cameras[i]->half_width = half_height_m * (float)view->size_px[0] / (float)view->size_px[1];
    }
}

static inline void test_end_passes(struct test_passes *test)
{
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        free(test->cpu.targets[t]);
    neph_rt_device_destroy(&test->device);
}

static inline size_t test_elements(const struct test_passes *test, int target)
{
    return (size_t)test->view.targets[target].width * test->view.targets[target].height;
}

static inline void test_set(struct test_passes *test, int target, size_t index,
                            const float value[4])
{
    neph_rt_store(&test->view.targets[target], test->cpu.targets[target], index, value);
}

/* Fills a target. */
static inline void test_fill(struct test_passes *test, int target, float r, float g, float b,
                             float a)
{
    for (size_t i = 0; i < test_elements(test, target); i++)
        test_set(test, target, i, (float[4]){r, g, b, a});
}

static inline void test_get(const struct test_passes *test, int target, size_t index,
                            float value[4])
{
    neph_rt_load(&test->view.targets[target], test->cpu.targets[target], index, value);
}

/* Uploads the view and the CPU reference's content of the targets that the pass declares, and runs
 * the pass on the device. */
static inline void test_passes_run(struct test_passes *test, const char *name)
{
    const struct neph_rt_pass *pass = neph_rt_passes[neph_rt_pass_index(name)];
    struct neph_diag diag = {0};
    assert_non_null(pass);
    *test->device.view = test->view;
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        if ((pass->reads | pass->writes) & NEPH_RT_BIT(t))
            neph_assert_ok(neph_rt_device_upload(&test->device, t, test->cpu.targets[t], &diag),
                           &diag);
    neph_assert_ok(neph_rt_device_run(&test->device, pass, &diag), &diag);
}

/* The words of a target on the device. The caller frees them. */
static inline uint32_t *test_words(struct neph_rt_device *device, int target)
{
    struct neph_diag diag = {0};
    uint32_t *words = malloc(neph_rt_device_words(device, target) * sizeof(*words));
    neph_assert_ok(neph_rt_device_download(device, target, words, &diag), &diag);
    return words;
}

static inline uint32_t *test_download(struct test_passes *test, int target)
{
    return test_words(&test->device, target);
}

/* Replaces the CPU reference's target with the device's. */
static inline void test_take(struct test_passes *test, int target)
{
    free(test->cpu.targets[target]);
    test->cpu.targets[target] = test_download(test, target);
}

static inline void test_swap(struct test_passes *test, int a, int b)
{
    uint32_t *words = test->cpu.targets[a];
    test->cpu.targets[a] = test->cpu.targets[b];
    test->cpu.targets[b] = words;
}

/* Asserts that all words of a target are equal on both sides. */
static inline void test_same_words(struct test_passes *test, int target, uint64_t seed)
{
    uint32_t *words = test_download(test, target);
    const size_t count = neph_rt_device_words(&test->device, target);
    for (size_t i = 0; i < count; i++)
        if (words[i] != test->cpu.targets[target][i])
            fail_msg(
                "seed %llu: word %zu of target %d is %08x on the device, %08x in the CPU reference",
                (unsigned long long)seed, i, target, words[i], test->cpu.targets[target][i]);
    free(words);
}

#endif

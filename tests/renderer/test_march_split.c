/* SPDX-License-Identifier: MIT
 *
 * Splitting a march into dispatches: at every speed of the device each ray takes each step once and
 * in order, and a dispatch takes the intended time.
 */
#include "tests/scene_builders.h"

#include "renderer/compute.h"
#include "renderer/march_split.h"

#include <math.h>
#include <string.h>

enum { RAYS = 100000, STEPS = 37, RAYS_MAX = 65536 };

static struct neph_march_split new_cut(void)
{
    return (struct neph_march_split){.ray_count = RAYS,
                                     .step_count = STEPS,
                                     .rays_max = RAYS_MAX,
                                     .rays = 4096,
                                     .steps = 10,
                                     .iterations_per_step = 7,
                                     .iterations_per_dispatch = 3};
}

static uint64_t turns_of_thread(const struct neph_march_split *cut)
{
    return cut->steps * cut->iterations_per_step + cut->iterations_per_dispatch;
}

struct marched {
    uint8_t steps[RAYS]; /* taken by each ray */
    uint32_t most_rays;
    int dispatches;
};

static enum neph_status march_on(const struct neph_gpu_march_run *run, void *context,
                                 struct neph_diag *diag)
{
    struct marched *marched = context;
    marched->dispatches++;
    if (run->ray_count > marched->most_rays)
        marched->most_rays = run->ray_count;
    for (uint32_t ray = run->first_ray; ray < run->first_ray + run->ray_count; ray++) {
        assert_int_equal(marched->steps[ray], run->first_step);
        marched->steps[ray] = (uint8_t)run->end_step;
    }
    return NEPH_OK;
}

static void assert_complete(const struct neph_march_split *cut, struct marched *marched)
{
    struct neph_diag diag = {0};
    memset(marched, 0, sizeof(*marched));
    neph_assert_ok(neph_march_split_run(cut, march_on, marched, &diag), &diag);
    for (int ray = 0; ray < RAYS; ray++)
        assert_int_equal(marched->steps[ray], STEPS);
    assert_int_equal(marched->dispatches == 1, neph_march_split_is_whole(cut));
}

static void test_each_ray_makes_each_step_once(void **state)
{
    static const double gpu_s[] = {1e-9, 1e-3, 0.04, 0.7, 30.0, 1e6};
    static struct marched marched;
    struct neph_march_split cut = new_cut();
    uint32_t before = RAYS;
    assert_complete(&cut, &marched);
    for (size_t i = 0; i < sizeof(gpu_s) / sizeof(gpu_s[0]); i++) {
        neph_march_split_adapt(&cut, gpu_s[i]);
        assert_complete(&cut, &marched);
        assert_true(marched.most_rays <= before && marched.most_rays <= RAYS_MAX);
        before = marched.most_rays;
    }
    assert_int_equal(before, NEPH_MARCH_LOCAL_SIZE);
    cut.iterations_least = 73 * 1000;
    neph_march_split_adapt(&cut, 1e6);
    assert_int_equal(cut.rays, 1000 / NEPH_MARCH_LOCAL_SIZE * NEPH_MARCH_LOCAL_SIZE);
}

/* A march of one second, and dispatches of 30 ms; the remainder is below a work group. */
static void test_a_dispatch_takes_its_time(void **state)
{
    struct neph_march_split cut = new_cut();
    neph_march_split_adapt(&cut, 1.0);
    const double turns = (double)RAYS * (STEPS * 7 + 3), group = NEPH_MARCH_LOCAL_SIZE * 73.0;
    const double dispatch = (double)cut.rays * (10 * 7 + 3);
    assert_true(dispatch <= 0.03 * turns && dispatch > 0.03 * turns - group);
}

static void test_without_a_clock_nothing_changes(void **state)
{
    static const double gpu_s[] = {NAN, 0.0, -1.0, INFINITY};
    struct neph_march_split cut = new_cut();
    for (size_t i = 0; i < sizeof(gpu_s) / sizeof(gpu_s[0]); i++) {
        neph_march_split_adapt(&cut, gpu_s[i]);
        assert_int_equal(cut.rays, 4096);
    }
    neph_march_split_adapt(&cut, 1e-3);
    neph_march_split_adapt(&cut, NAN);
    assert_int_equal(cut.rays, RAYS_MAX);
}

/* A grid's closed form walks through cells. A march that only sums over steps does not, and is not
 * split into steps because of it. */
static void test_closed_forms_count_where_there_are_some(void **state)
{
    static const enum neph_march_mode modes[] = {NEPH_MARCH_EXACT, NEPH_MARCH_MARCHED};
    const struct neph_vulkan vulkan = {.description.is_cpu = true,
                                       .limits.maxComputeWorkGroupCount = {65535}};
    const struct neph_gpu_scene gpu = {.optical_depth_iterations = 1200};
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.1, 0.0, 0.0);
    for (int i = 0; i < 4; i++) {
        const struct neph_march_params params = {
            .steps = 64, .sun_steps = 6, .transmittance = modes[i % 2], .sun = modes[i / 2]};
        struct neph_march_split cut;
        struct neph_diag diag = {0};
        neph_assert_ok(
            neph_march_split_make(&vulkan, &test.scene, &gpu, &params, RAYS, &cut, &diag), &diag);
        assert_int_equal(cut.step_count, 64);
        assert_int_equal(cut.steps == 64, i == 3);
        assert_true(turns_of_thread(&cut) <= NEPH_KERNEL_LOOP_ITERATIONS_MAX);
    }
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Sobol points with Owen scrambling: every elementary rectangle has one point for every scramble;
 * points are uniform; and the tracer with these numbers has the same mean as with random ones, less
 * noise where one decision causes most of it, and a correct noise estimate.
 */
#include "tests/renderer/frames.h"

#include "renderer/compute.h"

static const uint32_t probe_code[] = {
#include "shaders/probe_sobol.comp.inc"
};

enum { POINTS_LOG = 8, POINTS = 1 << POINTS_LOG };

struct run {
    uint32_t key[4], first, padding[3];
};

struct points {
    uint32_t of[POINTS][2];
};

static void ask(struct neph_vulkan *vulkan, const struct run *run, struct points *points)
{
    const struct neph_kernel_params params = {
        .name = "probe_sobol",
        .code = probe_code,
        .code_bytes = sizeof(probe_code),
        .buffer_count = 1,
        .push_size_bytes = sizeof(*run),
    };
    const struct neph_kernel *kernel;
    struct neph_buffer answers = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_kernel_get(vulkan, &params, &kernel, &diag), &diag);
    neph_assert_ok(
        neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, sizeof(*points), "answers", &answers, &diag),
        &diag);
    const struct neph_dispatch dispatch = {
        .buffers = {&answers}, .push = run, .group_count = POINTS / 64};
    neph_assert_ok(neph_kernel_run(vulkan, kernel, &dispatch, NULL, &diag), &diag);
    memcpy(points, answers.mapped, sizeof(*points));
    neph_buffer_destroy(vulkan, &answers);
}

/* 2^8 points from a multiple of 2^8 on: one in each rectangle of 2^-a by 2^-(8 - a). */
static void test_each_rectangle_has_its_point(void **state)
{
    uint64_t random = 3;
    for (int i = 0; i < 12; i++) {
        struct points points;
        struct run run = {.first = (uint32_t)i * POINTS};
        for (int k = 0; k < 4; k++)
            run.key[k] = (uint32_t)neph_test_random(&random);
        ask(*state, &run, &points);
        for (int a = 0; a <= POINTS_LOG; a++) {
            bool has[POINTS] = {false};
            for (int p = 0; p < POINTS; p++) {
                const uint64_t x = (uint64_t)points.of[p][0] >> (32 - a);
                const uint64_t y = (uint64_t)points.of[p][1] >> (32 - POINTS_LOG + a);
                has[(x << (POINTS_LOG - a)) + y] = true;
            }
            for (int p = 0; p < POINTS; p++)
                assert_true(has[p]);
        }
    }
}

/* One point of 400 scrambles: a uniform number has mean 1/2 and variance 1/12, and two of them have
 * covariance 0. Six standard errors. */
static void test_a_point_is_anywhere(void **state)
{
    enum { SCRAMBLES = 400, POINT = 5 };
    double sums[2] = {0.0, 0.0}, squares[2] = {0.0, 0.0}, product = 0.0;
    for (uint32_t i = 0; i < SCRAMBLES; i++) {
        struct points points;
        ask(*state, &(struct run){.key = {i, 1, 2, 3}}, &points);
        double off[2];
        for (int c = 0; c < 2; c++) {
            off[c] = ((double)points.of[POINT][c] + 0.5) * 0x1p-32 - 0.5;
            sums[c] += off[c];
            squares[c] += off[c] * off[c];
        }
        product += off[0] * off[1];
    }
    const double of_mean = 6.0 * sqrt(SCRAMBLES / 12.0), of_square = 6.0 * sqrt(SCRAMBLES / 180.0);
    for (int c = 0; c < 2; c++) {
        assert_true(fabs(sums[c]) < of_mean);
        assert_true(fabs(squares[c] - SCRAMBLES / 12.0) < of_square);
    }
    assert_true(fabs(product) < 6.0 * sqrt(SCRAMBLES / 144.0));
}

/* --- the tracer ------------------------------------------------------------------------------- */

enum { WIDTH_PX = 24, HEIGHT_PX = 14, PIXELS = WIDTH_PX * HEIGHT_PX, SAMPLES = 64 };

/* Two seeds: the mean of all light, the noise from their difference, and the noise that they
 * report. */
struct noise {
    double mean, seen2, told2;
};

static struct neph_image *render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                 bool sobol, uint64_t seed)
{
    const struct neph_tracer_params params = {.width_px = WIDTH_PX,
                                              .height_px = HEIGHT_PX,
                                              .seed = seed,
                                              .sobol = sobol,
                                              .samples = SAMPLES,
                                              .time_limit_s = INFINITY};
    return test_trace(vulkan, scene, &params, NULL);
}

static struct noise measure_noise(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  bool sobol)
{
    struct neph_image *frames[2];
    struct test_rgb light[2], variance[2];
    struct noise noise = {0.0, 0.0, 0.0};
    for (int s = 0; s < 2; s++) {
        frames[s] = render(vulkan, scene, sobol, 20 + (uint64_t)s);
        light[s] = test_layer(frames[s], NULL);
        variance[s] = test_layer(frames[s], "variance");
    }
    for (int c = 0; c < 3; c++)
        for (int p = 0; p < PIXELS; p++) {
            const double a = (double)light[0].of[c][p], b = (double)light[1].of[c][p];
            noise.mean += 0.5 * (a + b) / (3 * PIXELS);
            noise.seen2 += 0.5 * (a - b) * (a - b) / (3 * PIXELS);
            noise.told2 += 0.5 * ((double)variance[0].of[c][p] + (double)variance[1].of[c][p]) /
                           (3 * PIXELS);
        }
    for (int s = 0; s < 2; s++)
        neph_image_destroy(frames[s]);
    return noise;
}

/* Means of `count` squares with one degree of freedom in a few hundred independent pixels: 6
 * standard errors of the ratio of two such means if all pixels were alike; in fact a third of them
 * have the noise. */
static const double told_ratio = 2.2;

static void check(struct neph_vulkan *vulkan, const struct neph_scene *scene, double gain_least)
{
    const struct noise random = measure_noise(vulkan, scene, false);
    const struct noise sobol = measure_noise(vulkan, scene, true);
    const double gain = random.seen2 / sobol.seen2;
    print_message("noise^2 %.3g, told %.3g; by Sobol %.3g, told %.3g: %.2f times less\n",
                  random.seen2, random.told2, sobol.seen2, sobol.told2, gain);
    /* Six standard errors of a mean over pixels, of both. */
    assert_true(fabs(random.mean - sobol.mean) <
                6.0 * sqrt((random.told2 + sobol.told2) / (2.0 * PIXELS)));
    assert_true(gain > gain_least);
    assert_true(sobol.told2 < told_ratio * sobol.seen2 && sobol.seen2 < told_ratio * sobol.told2);
}

static struct neph_medium *add_blob(struct test_scene *test, double extinction_per_m)
{
    const struct neph_vec3 at_m = {0.5, 2.0, -12.0}, reach_m = {4.5, 4.5, 4.5};
    struct neph_medium *blob = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, extinction_per_m);
    blob->gaussian = (struct neph_gaussian){at_m, 1.5};
    blob->bounds = (struct neph_bounds){neph_vec3_sub(at_m, reach_m), neph_vec3_add(at_m, reach_m)};
    return blob;
}

/* Single scattering is an integral over one number: 32 points of a sequence in place of strata of
 * four reduce the noise to a small part. */
static void test_light_scattered_once_gains_much(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_blob(&test, 0.8);
    check(*state, &test.scene, 3.0);
}

/* For all orders the first decisions are a small part: the noise does not increase, and the mean is
 * unbiased. */
static void test_all_orders_lose_nothing(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_blob(&test, 0.8);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    check(*state, &test.scene, 0.7);
}

#include "tests/renderer/main.h"

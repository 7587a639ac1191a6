/* SPDX-License-Identifier: MIT
 *
 * Tests of the upscale: the shader against the CPU reference, constants, edges, ridges, invalid
 * history, and the place at which a pixel reads.
 */
#include "tests/renderer/realtime_test.h"

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};
enum { SMALL_SIZES = 5, SIZES = 6 };

static size_t pixel_count(const struct test_passes *test)
{
    return (size_t)test->view.size_px[0] * test->view.size_px[1];
}

static void run_upscale(struct test_passes *test)
{
    test_passes_run(test, "upscale");
    test_take(test, RT_VOLUME);
}

/* ---- against the CPU reference ------------------------------------------------------------ */

/* Few depths, so that they often agree, some on either side of a limit: 25 % of 10 m, sky_m and
 * ray_depth_max_m. */
static float random_depth_m(uint64_t *seed)
{
    static const float depths_m[] = {10,    12.499999f, 12.5f, 7.5f,  100,           9999,
                                     10001, 15001,      19000, 26667, NEPH_GPU_FAR_M};
    return depths_m[neph_test_random(seed) % (COUNT(depths_m))];
}

static float random_radiance(uint64_t *seed)
{
    return (float)pow(10.0, 8.0 * test_uniform(seed) - 4.0);
}

/* `bad`: one half-resolution texel in `bad` has invalid values; 0: none. */
static void fill(struct test_passes *test, uint64_t *seed, unsigned bad)
{
    static const float bads[] = {NAN, INFINITY, -INFINITY, -1.0f, 1e30f};
    for (size_t i = 0; i < test_elements(test, RT_DEPTH); i++)
        test_set(test, RT_DEPTH, i, (float[4]){random_depth_m(seed)});
    for (size_t i = 0; i < test_elements(test, RT_HISTORY); i++) {
        float volume[4] = {random_radiance(seed), random_radiance(seed), random_radiance(seed),
                           (float)test_uniform(seed)};
        float state[4] = {(float)(1 + neph_test_random(seed) % 4),
                          (float)pow(10.0, 1.0 + 3.7 * test_uniform(seed))};
        if (bad && neph_test_random(seed) % bad == 0) {
            const float value = bads[neph_test_random(seed) % 5];
            const uint64_t which = neph_test_random(seed) % 7;
            if (which < 4)
                volume[which] = value;
            else
                state[which % 2] = which == 6 ? 0.0f : value;
        }
        test_set(test, RT_HISTORY, i, volume);
        test_set(test, RT_HISTORY_STATE, i, state);
        test_set(test, RT_HALF_DEPTH, i, (float[4]){random_depth_m(seed)});
    }
}

/* Decisions are equal; blended values differ by rounding, at most (in halves of ulps, one for each
 * operation on terms that are not negative): weight 3, their sum 3 + 3, division 5, product 1, sum
 * 3: 18 halves, 9 ulps of 2^-23; values in half precision by one more step of theirs, 2^-10. */
static void assert_same_volumes(struct test_passes *test, const char *assignments, uint64_t seed)
{
    const bool is_half = test->view.targets[RT_VOLUME].format == RT_RGBA16F;
    OWNED(memory) uint32_t *words = test_download(test, RT_VOLUME);
    const struct neph_gpu_target *shape = &test->view.targets[RT_VOLUME];
    for (size_t i = 0; i < test_elements(test, RT_VOLUME); i++) {
        float made[4], expected[4];
        neph_rt_load(shape, words, i, made);
        test_get(test, RT_VOLUME, i, expected);
        for (int c = 0; c < 4; c++) {
            const float allowed = fabsf(expected[c]) * (is_half ? 0x1p-10f : 9 * 0x1p-23f) +
                                  (is_half ? 0x1p-24f : 0.0f);
            if (!(made[c] == expected[c] || fabsf(made[c] - expected[c]) <= allowed))
                fail_msg("%s, seed %llu: channel %d of pixel %zu is %a on the device, %a in the "
                         "CPU reference",
                         assignments, (unsigned long long)seed, c, i, (double)made[c],
                         (double)expected[c]);
        }
    }
}

static void compare(struct neph_vulkan *vulkan, const char *assignments, const int size_px[2],
                    unsigned bad, uint64_t *seed)
{
    const uint64_t start = *seed;
    const struct neph_settings settings = test_settings(assignments);
    const int origin_px[2] = {neph_test_random(seed) % 2 ? 8 : 0,
                              neph_test_random(seed) % 2 ? 4 : 0};
    OWNED(passes) struct test_passes test;
    test_passes_open(vulkan, &settings, size_px, origin_px, start, &test);
    test.view.frame = (uint32_t)(neph_test_random(seed) % 100);
    for (int axis = 0; axis < 2; axis++)
        test.view.jitter_px[axis] = (float)(test_uniform(seed) - 0.5);
    fill(&test, seed, bad);
    test_passes_run(&test, "upscale");
    cpu_upscale(&test.cpu);
    assert_same_volumes(&test, assignments, start);
    test_same_words(&test, RT_VOLUME_DISTANCE, start);
}

static const char *const variants[] = {
    "",
    "upscale=nearest",
    "upscale=bilinear",
    "upscale=bilateral",
    "upscale=nearest target_format=float",
    "upscale=bilinear target_format=float",
    "upscale=mean target_format=float",
    "upscale=bilateral target_format=float",
    "upscale=mean upscale_contrast=0.2 upscale_depth=0.1",
    "upscale=nearest upscale_contrast=0.5",
    "upscale=bilateral upscale_contrast=0.5",
    "upscale=bilateral upscale_depth=0",
    "upscale_dither=none",
    "upscale_dither=white upscale_law=constant",
    "upscale_dither=interleaved upscale_law=constant upscale_amount_px=4",
    "upscale_dither=blue upscale_law=constant upscale_amount_px=2",
    "upscale_dither=blue upscale_law=constant upscale_pair=shared",
    "upscale_dither=white upscale_pair=shared upscale=bilinear",
    "ray_depth_max_m=10000 clamp_pixel_depth=on",
    "ray_depth_max_m=10000 clamp_pixel_depth=off",
    "far=infinite jittered_depth=on",
    "upscale=inverse upscale_depth=0.1",
    "upscale=inverse upscale_tolerance_m=100 upscale_dither=white upscale_law=constant",
    "upscale=square upscale_same_kind=on",
    "upscale=square upscale_contrast=0.5 contrast=opacity jittered_depth=on upscale_dither=none",
    "upscale=mean upscale_same_kind=on upscale_contrast=0.5 contrast=opacity",
    "upscale_dither=slice",
    "validity=off",
};
enum { VARIANTS = COUNT(variants) };

/* By day each variant has two of the sizes, one variant the largest. */
static void test_upscale_equals_the_cpu_reference(void **state)
{
    uint64_t seed = 20261127;
    for (int v = 0; v < VARIANTS; v++)
        for (int s = 0; s < (v == 0 || v == 14 ? SIZES : SMALL_SIZES); s++)
            if (neph_test_is_night() || s == v % 3 || s == 3 + v % 2 || (s == 5 && v == 14))
                compare(*state, variants[v], sizes_px[s], 0, &seed);
}

static void test_bad_history_equals_the_cpu_reference(void **state)
{
    uint64_t seed = 20261128;
    for (int v = 0; v < VARIANTS; v++)
        if (!strstr(variants[v], "validity=off"))
            compare(*state, variants[v], sizes_px[3 + v % 2], v % 2 ? 2 : 16, &seed);
}

/* ---- values ---------------------------------------------------------------------------------- */

/* For any weights of the taps, bit by bit. */
static void test_constants_stay_constant(void **state)
{
    uint64_t seed = 20261129;
    for (int v = 0; v < VARIANTS; v++) {
        const uint64_t start = seed;
        const struct neph_settings settings = test_settings(variants[v]);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[4], (int[2]){0, 0}, seed, &test);
        fill(&test, &seed, 0);
        const float volume[4] = {random_radiance(&seed), random_radiance(&seed), 0.0f,
                                 (float)test_uniform(&seed)};
        for (size_t i = 0; i < test_elements(&test, RT_HISTORY); i++)
            test_set(&test, RT_HISTORY, i, volume);
        test_passes_run(&test, "upscale");
        for (size_t y = 0; y < test.view.size_px[1]; y++)
            for (size_t x = 0; x < test.view.size_px[0]; x++)
                test_set(&test, RT_VOLUME, y * test.view.targets[RT_VOLUME].width + x, volume);
        test_same_words(&test, RT_VOLUME, start);
    }
}

/* Validity: invalid taps have no effect, and a pixel with only invalid taps is invalid. */
static void test_bad_history_has_no_effect(void **state)
{
    uint64_t seed = 20261130;
    for (int v = 0; v < VARIANTS; v++) {
        if (strstr(variants[v], "validity=off"))
            continue;
        const struct neph_settings settings = test_settings(variants[v]);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[3], (int[2]){0, 0}, seed, &test);
        fill(&test, &seed, 2);
        const int sound_columns = 24;
        for (int y = 0; y < (int)test.view.half_size_px[1]; y++)
            for (int x = sound_columns; x < (int)test.view.half_size_px[0]; x++)
                cpu_put_half(&test.cpu, RT_HISTORY_STATE, x, y, (float[4]){0, 100});
        run_upscale(&test);
        for (int y = 0; y < sizes_px[3][1]; y++)
            for (int x = 0; x < sizes_px[3][0]; x++) {
                float volume[4];
                cpu_fetch_full(&test.cpu, RT_VOLUME, x, y, volume);
                assert_true(cpu_is_valid(volume));
                /* The largest shift is 4 texels, and the left taps are up to one away. */
                if (x >= 2 * (sound_columns + 5))
                    assert_true(volume[0] == 0.0f && volume[3] == 1.0f);
            }
    }
}

/* One NaN in the history is in the output unless validity is on. */
static void test_validity_keeps_a_nan_out(void **state)
{
    for (int validity = 0; validity < 2; validity++) {
        const struct neph_settings settings = test_settings(validity ? "validity=on"
                                                                     : "validity=off");
        uint64_t seed = 3;
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[3], (int[2]){0, 0}, seed, &test);
        fill(&test, &seed, 0);
        cpu_put_half(&test.cpu, RT_HISTORY, 12, 7, (float[4]){NAN, NAN, NAN, NAN});
        run_upscale(&test);
        int bad = 0;
        for (size_t i = 0; i < test_elements(&test, RT_VOLUME); i++) {
            float volume[4];
            test_get(&test, RT_VOLUME, i, volume);
            bad += isnan(volume[0]);
        }
        assert_true(validity ? bad == 0 : bad > 0);
    }
}

/* ---- the place ------------------------------------------------------------------------------- */

/* Bilinear, with a history whose values are its coordinates: the output is the place at which each
 * pixel reads. */
static void open_ramp(struct neph_vulkan *vulkan, const char *assignments, float transmittance,
                      float distance_m, struct test_passes *test)
{
    char words[256];
    snprintf(words, sizeof(words), "upscale=bilinear target_format=float %s", assignments);
    const struct neph_settings settings = test_settings(words);
    test_passes_open(vulkan, &settings, sizes_px[3], (int[2]){0, 0}, 99, test);
    const uint32_t width = test->view.targets[RT_HISTORY].width;
    for (size_t i = 0; i < test_elements(test, RT_HISTORY); i++) {
        test_set(test, RT_HISTORY, i,
                 (float[4]){(float)(i % width), (float)(i / width), 0, transmittance});
        test_set(test, RT_HISTORY_STATE, i, (float[4]){1, distance_m});
    }
}

/* Shift of a pixel's place from its centre, in texels, from the device's output. */
static void shift_at(const struct test_passes *test, int x, int y, double shift[2])
{
    float volume[4];
    cpu_fetch_full(&test->cpu, RT_VOLUME, x, y, volume);
    shift[0] = (double)volume[0] - (0.5 * x - 0.25);
    shift[1] = (double)volume[1] - (0.5 * y - 0.25);
}

/* Interpolation between coordinates up to 32 with weights of 2^-24: 32 * 9 ulps. */
static const double ramp_rounding = 32 * 9 * 0x1p-23;

/* Pixels whose taps are within the view for shifts up to one texel. */
enum { MARGIN = 6 };

static void test_the_place_of_a_pixel(void **state)
{
    static const struct {
        const char *assignments;
        double shift; /* for jitter (0.25, -0.375) */
    } cases[] = {
        {"upscale_dither=none", 0.5},
        {"upscale_dither=none jittered_depth=on", 0.0},
    };
    for (size_t k = 0; k < 2; k++) {
        OWNED(passes) struct test_passes test;
        open_ramp(*state, cases[k].assignments, 0.0f, 10.0f, &test);
        test.view.jitter_px[0] = 0.25f;
        test.view.jitter_px[1] = -0.375f;
        run_upscale(&test);
        for (int y = MARGIN; y < sizes_px[3][1] - MARGIN; y++)
            for (int x = MARGIN; x < sizes_px[3][0] - MARGIN; x++) {
                double shift[2];
                shift_at(&test, x, y, shift);
                neph_assert_close(shift[0], cases[k].shift * 0.25, 0.0, ramp_rounding);
                neph_assert_close(shift[1], cases[k].shift * -0.375, 0.0, ramp_rounding);
            }
    }
}

/* amount (1 - T) max(0, 1 - distance / 4 km), from the largest shifts that occur: in 64 x 36 pixels
 * the largest number of either sign is within 1 % of 1 except with probability 0.99^1000. */
static void test_the_law_of_the_shift(void **state)
{
    static const struct {
        float transmittance, distance_m;
        double amount;
    } cases[] = {
        {0.0f, 0.0f, 1.0},     {0.5f, 0.0f, 0.5},        {1.0f, 10.0f, 0.0},
        {0.0f, 2000.0f, 0.5},  {0.0f, 3000.0f, 0.25},    {0.0f, 4000.0f, 0.0},
        {0.0f, 50000.0f, 0.0}, {0.25f, 1000.0f, 0.5625},
    };
    for (size_t k = 0; k < COUNT(cases); k++)
        for (int is_constant = 0; is_constant < 2; is_constant++) {
            const double amount = is_constant ? 1.0 : cases[k].amount;
            OWNED(passes) struct test_passes test;
            open_ramp(*state,
                      is_constant ? "upscale_dither=white upscale_law=constant"
                                  : "upscale_dither=white upscale_law=opacity",
                      cases[k].transmittance, cases[k].distance_m, &test);
            run_upscale(&test);
            double least = 0.0, most = 0.0;
            for (int y = MARGIN; y < sizes_px[3][1] - MARGIN; y++)
                for (int x = MARGIN; x < sizes_px[3][0] - MARGIN; x++) {
                    double shift[2];
                    shift_at(&test, x, y, shift);
                    least = fmin(least, fmin(shift[0], shift[1]));
                    most = fmax(most, fmax(shift[0], shift[1]));
                }
            neph_assert_close(most, amount, 0.01, ramp_rounding);
            neph_assert_close(least, -amount, 0.01, ramp_rounding);
        }
}

/* Measured in the output: with `shared` the two shifts of a pixel keep their difference, modulo 2,
 * over 16 frames, and restart; with `independent` they do not. */
static void test_shared_shifts_stay_on_a_line(void **state)
{
    for (int is_shared = 0; is_shared < 2; is_shared++) {
        OWNED(passes) struct test_passes test;
        open_ramp(*state,
                  is_shared ? "upscale_law=constant upscale_dither=blue upscale_pair=shared"
                            : "upscale_law=constant upscale_dither=blue upscale_pair=independent",
                  0.0f, 0.0f, &test);
        static double first[64][64][2];
        double farthest = 0.0, diagonal = 0.0;
        for (uint32_t frame = 0; frame <= 16; frame++) {
            test.view.frame = frame;
            run_upscale(&test);
            for (int y = MARGIN; y < sizes_px[3][1] - MARGIN; y++)
                for (int x = MARGIN; x < sizes_px[3][0] - MARGIN; x++) {
                    double shift[2], *start = first[y][x];
                    shift_at(&test, x, y, shift);
                    if (frame == 0)
                        memcpy(start, shift, sizeof(shift));
                    const double change = (shift[0] - shift[1]) - (start[0] - start[1]);
                    farthest = fmax(farthest, fabs(change - 2.0 * round(change / 2.0)));
                    if (x == y)
                        diagonal = fmax(diagonal, fabs(shift[0] - shift[1]));
                    if (frame == 16 && is_shared)
                        neph_assert_close(shift[0], start[0], 0.0, 2 * ramp_rounding);
                }
        }
        if (is_shared) {
            assert_true(farthest < 4 * ramp_rounding);
            assert_true(diagonal < 2 * ramp_rounding);
        } else {
            assert_true(farthest > 0.9); /* of 1 */
            assert_true(diagonal > 0.9); /* of 2 */
        }
    }
}

/* The result does not depend on the place of the view in its buffers. */
static void test_a_view_rectangle_is_a_view(void **state)
{
    float *volumes[2];
    const int size_px[2] = {61, 35}, origins_px[2][2] = {{0, 0}, {12, 8}};
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 5;
        const struct neph_settings settings = test_settings("upscale_law=constant");
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, size_px, origins_px[k], 5, &test);
        fill(&test, &(uint64_t){77}, 0); /* also outside the view */
        for (int y = 0; y < size_px[1]; y++)
            for (int x = 0; x < size_px[0]; x++)
                cpu_put_full(&test.cpu, RT_DEPTH, x, y, (float[4]){random_depth_m(&seed)});
        for (int y = 0; y < (int)test.view.half_size_px[1]; y++)
            for (int x = 0; x < (int)test.view.half_size_px[0]; x++) {
                cpu_put_half(&test.cpu, RT_HALF_DEPTH, x, y, (float[4]){random_depth_m(&seed)});
                cpu_put_half(&test.cpu, RT_HISTORY, x, y,
                             (float[4]){random_radiance(&seed), 1, 2, 0.5f});
                cpu_put_half(&test.cpu, RT_HISTORY_STATE, x, y, (float[4]){1, 100});
            }
        run_upscale(&test);
        volumes[k] = malloc(pixel_count(&test) * 4 * sizeof(float));
        for (int y = 0; y < size_px[1]; y++)
            for (int x = 0; x < size_px[0]; x++)
                cpu_fetch_full(&test.cpu, RT_VOLUME, x, y, volumes[k] + 4 * (y * size_px[0] + x));
    }
    assert_memory_equal(volumes[0], volumes[1],
                        (size_t)size_px[0] * (size_t)size_px[1] * 4 * sizeof(float));
    free(volumes[0]);
    free(volumes[1]);
}

/* ---- edges ----------------------------------------------------------------------------------- */

static const float near_value = 1.0f, far_value = 1000.0f;

/* A scene of two depths, its depth map, and a history that has one value on each. The near part is
 * a x + b y < c. */
static void open_edge(struct neph_vulkan *vulkan, const char *assignments, const int line[3],
                      const float depths_m[2], struct test_passes *test)
{
    const struct neph_settings settings = test_settings(assignments);
    test_passes_open(vulkan, &settings, sizes_px[3], (int[2]){0, 0}, 99, test);
    for (int y = 0; y < sizes_px[3][1]; y++)
        for (int x = 0; x < sizes_px[3][0]; x++) {
            const bool is_near = line[0] * x + line[1] * y < line[2];
            const float depth[4] = {depths_m[!is_near]};
            cpu_put_full(&test->cpu, RT_DEPTH, x, y, depth);
            cpu_put_full(&test->cpu, RT_STEADY_DEPTH, x, y, depth);
        }
    cpu_min_max(&test->cpu);
    for (size_t i = 0; i < test_elements(test, RT_HALF_DEPTH); i++) {
        float depth[4];
        test_get(test, RT_HALF_DEPTH, i, depth);
        test_set(test, RT_HISTORY, i,
                 (float[4]){depth[0] == depths_m[0] ? near_value : far_value, 0, 0,
                            depth[0] == depths_m[0] ? 0.9f : 0.1f});
        test_set(test, RT_HISTORY_STATE, i, (float[4]){1, 100});
    }
}

/* The part of all pixels that contain any light of the other side. */
static double leaking_part(struct neph_vulkan *vulkan, const char *assignments, const int line[3],
                           const float depths_m[2])
{
    OWNED(passes) struct test_passes test;
    open_edge(vulkan, assignments, line, depths_m, &test);
    run_upscale(&test);
    int leaking = 0;
    for (int y = 0; y < sizes_px[3][1]; y++)
        for (int x = 0; x < sizes_px[3][0]; x++) {
            float depth[4], volume[4];
            cpu_fetch_full(&test.cpu, RT_DEPTH, x, y, depth);
            cpu_fetch_full(&test.cpu, RT_VOLUME, x, y, volume);
            leaking += volume[0] != (depth[0] == depths_m[0] ? near_value : far_value);
        }
    const double part = leaking / (double)pixel_count(&test);
    return part;
}

static const float edge_m[2] = {10, NEPH_GPU_FAR_M};

/* Edges along the axes, at each place in a tile: no pixel contains the other side, except
 * bilinear. */
static void test_edges_do_not_leak(void **state)
{
    static const char *const tight[] = {"upscale_dither=none upscale=nearest",
                                        "upscale_dither=none upscale=mean",
                                        "upscale_dither=none upscale=bilateral"};
    for (int phase = 0; phase < 4; phase++)
        for (int axis = 0; axis < 2; axis++) {
            const int line[3] = {!axis, axis, 16 + phase};
            for (int k = 0; k < 3; k++)
                assert_true(leaking_part(*state, tight[k], line, edge_m) == 0.0);
            assert_true(leaking_part(*state, "upscale_dither=none upscale=bilinear", line, edge_m) >
                        0.0);
        }
}

/* Few places at a sloped edge have no texel of their own side among four: 1 of 2304 pixels where
 * one was found; with bilinear 95 .. 253 leak. */
static void test_sloped_edges_hardly_leak(void **state)
{
    static const int lines[][3] = {{1, 1, 50}, {1, 2, 60}, {3, 1, 100}, {1, -1, 11}, {1, -3, -5}};
    for (size_t k = 0; k < COUNT(lines); k++) {
        const double mean = leaking_part(*state, "upscale_dither=none", lines[k], edge_m);
        const double bilinear = leaking_part(*state, "upscale_dither=none upscale=bilinear",
                                             lines[k], edge_m);
        assert_true(mean <= 1 / 2304.0);
        assert_true(bilinear >= 90 / 2304.0);
    }
}

/* A ridge takes its own light at any distance: the sky counts as 1000 km, and pixel and taps have
 * the same limits of depth. */
static void test_ridges_are_not_sky(void **state)
{
    static const float ridges_m[] = {9e3f, 12e3f, 14.9e3f, 15.1e3f, 18e3f, 26e3f, 30e3f, 60e3f};
    static const char *const words[] = {"upscale_dither=none",
                                        "upscale_dither=none ray_depth_max_m=10000",
                                        "upscale_dither=none clamp_pixel_depth=off"};
    static const int line[3] = {1, 1, 50};
    for (size_t k = 0; k < COUNT(ridges_m); k++) {
        const float depths_m[2] = {ridges_m[k], NEPH_GPU_FAR_M};
        for (size_t i = 0; i < COUNT(words); i++)
            assert_true(leaking_part(*state, words[i], line, depths_m) <= 1 / 2304.0);
    }
}

/* The taps' transmittances are 0.9 and 0.1: a contrast of 0.8 / 0.9 = 0.889. */
static void test_depth_matters_only_with_contrast(void **state)
{
    static const char *const modes[] = {"nearest", "mean", "bilateral"};
    static const int line[3] = {1, 0, 17};
    for (int k = 0; k < 3; k++)
        for (int is_above = 0; is_above < 2; is_above++) {
            char words[96];
            snprintf(words, sizeof(words), "upscale_dither=none upscale=%s upscale_contrast=%s",
                     modes[k], is_above ? "0.9" : "0.88");
            const double part = leaking_part(*state, words, line, edge_m);
            assert_true(is_above ? part > 0.0 : part == 0.0);
        }
}

#include "tests/renderer/main.h"

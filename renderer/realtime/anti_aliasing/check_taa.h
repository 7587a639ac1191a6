/* SPDX-License-Identifier: MIT
 *
 * Shared by tests of temporal anti-aliasing and of upsampling: random frames, cameras and settings,
 * and the allowed difference between device and CPU reference.
 */
#ifndef NEPH_TESTS_TAA_TEST_H
#define NEPH_TESTS_TAA_TEST_H

#include "tests/renderer/realtime_test.h"

static const double float_ulp = 0x1p-24, half_ulp = 0x1p-11; /* relative, rounded to nearest */

/* float32 has the cameras' axes to 6e-8 and places in 127 pixels to 8e-6 px: a multiple of that. */
static const double motion_error_px = 1e-4;

/* Rotated by up to `turn_rad` about all axes and moved by up to `displacement_m` since the frame
 * before. */
static inline void move_camera(struct neph_gpu_view *view, double turn_rad, double displacement_m,
                               uint64_t *seed)
{
    const double yaw = neph_test_uniform(seed, -turn_rad, turn_rad),
                 roll = neph_test_uniform(seed, -turn_rad, turn_rad);
    const double pitch = neph_test_uniform(seed, -turn_rad, turn_rad);
    const double forward[3] = {sin(yaw) * cos(pitch), sin(pitch), -cos(yaw) * cos(pitch)};
    const double level[3] = {cos(yaw), 0.0, sin(yaw)};
    const double above[3] = {-sin(yaw) * sin(pitch), cos(pitch), cos(yaw) * sin(pitch)};
    for (int c = 0; c < 3; c++) {
        view->before.forward[c] = (float)forward[c];
        view->before.right[c] = (float)(cos(roll) * level[c] + sin(roll) * above[c]);
        view->before.up[c] = (float)(cos(roll) * above[c] - sin(roll) * level[c]);
        view->before.position_m[c] = (float)neph_test_uniform(seed, -displacement_m,
                                                              displacement_m);
    }
}

static inline float random_depth_m(uint64_t *seed)
{
    switch (neph_test_random(seed) % 8) {
    case 0:
        return NEPH_GPU_FAR_M;
    case 1:
        return INFINITY;
    default:
        return (float)exp(neph_test_uniform(seed, 0.0, 14.0));
    }
}

/* Radiance up to `most`, some of it black, some flat. */
static inline void fill_colours(struct test_passes *test, int target, double most, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, target); i++) {
        float colour[4] = {0.0f};
        const int kind = (int)(neph_test_random(seed) % 8);
        for (int c = 0; c < 3 && kind > 0; c++)
            colour[c] = (float)(kind == 1 ? 0.5 * most : neph_test_uniform(seed, 0.0, most));
        test_set(test, target, i, colour);
    }
}

static inline void fill_depths(struct test_passes *test, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, RT_DEPTH); i++)
        test_set(test, RT_DEPTH, i, (float[4]){random_depth_m(seed)});
}

/* Clouds at all distances, at some pixels none; changes and ages of any kind. */
static inline void fill_medium(struct test_passes *test, uint64_t *seed)
{
    static const float ages[] = {0.0f, 1.0f, 3.0f, 100.0f, 255.0f, -1.0f, NAN, 4096.0f};
    for (size_t i = 0; i < test_elements(test, RT_VOLUME); i++) {
        const float through = neph_test_random(seed) % 8 ? (float)test_uniform(seed) : 1.0f;
        float colour[4]; /* of which the medium has a share, in some pixels more than all */
        test_get(test, RT_COLOR, i, colour);
        const float part = (float)(1.1 * test_uniform(seed));
        test_set(test, RT_VOLUME, i,
                 (float[4]){part * colour[0], part * colour[1], part * colour[2], through});
        test_set(test, RT_VOLUME_DISTANCE, i, (float[4]){random_depth_m(seed)});
    }
    for (size_t i = 0; i < test_elements(test, RT_TAA_BEFORE); i++) {
        float before[4];
        test_get(test, RT_TAA_BEFORE, i, before);
        before[3] = ages[neph_test_random(seed) % 8];
        test_set(test, RT_TAA_BEFORE, i, before);
    }
    for (size_t i = 0; i < 2 * test_elements(test, RT_CHANGE); i++) {
        float change[4];
        for (int c = 0; c < 3; c++)
            change[c] = (float)neph_test_uniform(seed, 0.9, 1.1);
        change[3] = neph_test_random(seed) % 3 ? 0.0f : (float)(0.3 * test_uniform(seed));
        test_set(test, i % 2 ? RT_CHANGE : RT_CHANGE_BEHIND, i / 2, change);
    }
    for (int c = 0; c < 3; c++)
        test->view.wind_m[c] = (float)neph_test_uniform(seed, -5.0, 5.0);
}

/* Motion of each pixel's surface. Has its own random sequence, so that others stay the same. */
static inline void fill_moves(struct test_passes *test, uint64_t seed)
{
    for (size_t i = 0; i < test_elements(test, RT_MOVED); i++) {
        float displacement_m[4] = {0.0f};
        for (int c = 0; c < 3 && neph_test_random(&seed) % 2; c++)
            displacement_m[c] = (float)neph_test_uniform(&seed, -1.0, 1.0);
        displacement_m[3] = neph_test_random(&seed) % 4 == 0;
        test_set(test, RT_MOVED, i, displacement_m);
    }
}

/* Fills the inputs of a frame, different in each round: colours, depths, media, movers, a camera;
 * every 16th without history, every fifth with another exposure. Returns the largest brightness. */
static inline double fill_round(struct test_passes *test, int round, uint64_t *seed)
{
    static const double brightest[] = {1e-3, 1.0, 100.0, 6e4};
    const double most = brightest[neph_test_random(seed) % 4];
    const bool is_exposed = round % 5 == 2;
    test->view.frame = (uint32_t)neph_test_random(seed);
    test->view.has_history = round % 16 != 0;
    for (int axis = 0; axis < 2; axis++)
        test->view.jitter_px[axis] = (float)neph_test_uniform(seed, -0.5, 0.5);
    if (round % 4)
        move_camera(&test->view, round % 4 == 1 ? 3.1 : 0.02, 2.0, seed);
    fill_depths(test, seed);
    fill_colours(test, RT_COLOR, most, seed);
    fill_colours(test, RT_TAA_BEFORE, most, seed);
    fill_medium(test, seed);
    if (is_exposed) {
        test->view.exposure = 8.0f;
        test->view.exposure_before = 0.5f;
    }
    if (round % 3 == 1)
        fill_moves(test, *seed);
    return is_exposed ? 16.0 * most : most;
}

static inline double pixel_value(const struct test_passes *test, int target, int x, int y,
                                 int channel)
{
    float value[4];
    (neph_rt_has_output_size(target) ? cpu_fetch_output : cpu_fetch_full)(&test->cpu, target, x, y,
                                                                          value);
    return value[channel];
}

/* A random choice for every setting; also returned as text, to be printed. */
static inline struct neph_settings random_settings(uint64_t *seed, char *text, size_t text_size)
{
    static const struct {
        const char *name;
        const char *values[5];
    } choices[] = {
        {"taa_motion", {"centre", "cross"}},
        {"taa_space", {"linear", "reinhard", "ycocg"}},
        {"taa_hdr_weight", {"off", "on"}},
        {"taa_filter", {"off", "on"}},
        {"taa_box", {"none", "min_max", "variance", "distance"}},
        {"taa_sigma", {"0", "0.75", "1.25"}},
        {"taa_history", {"nearest", "bilinear", "catmull_rom"}},
        {"taa_alpha", {"0", "0.04", "0.5", "1"}},
        {"taa_contrast", {"0", "0.01"}},
        {"taa_format", {"half", "float"}},
        {"taa_rounding", {"nearest", "stochastic"}},
        {"taa_guard", {"off", "on"}},
        {"cut_reset", {"off", "on"}},
        {"wind", {"off", "on"}},
        {"gradient", {"off", "on"}},
        {"taa_medium", {"off", "on"}},
        {"taa_age_max", {"0", "1", "8", "255"}},
        {"taa_change", {"0", "0.1", "0.5"}},
    };
    uint64_t own = *seed; /* its own random sequence, so that others stay the same */
    size_t length = (size_t)snprintf(
        text, text_size, "relight=%s taa_responsive=%s taa_pre_exposure=%s ",
        neph_test_random(&own) % 2 ? "0.1" : "0", neph_test_random(&own) % 3 ? "off" : "medium",
        neph_test_random(&own) % 2 ? "on" : "off");
    static const char *const ages[] = {"0", "3", "19"}, *const full_changes[] = {"0", "0.2", "0.6"};
    length += (size_t)snprintf(text + length, text_size - length, "taa_age_least=%s ",
                               ages[neph_test_random(&own) % 3]);
    length += (size_t)snprintf(text + length, text_size - length, "taa_change_full=%s ",
                               full_changes[neph_test_random(&own) % 3]);
    for (size_t i = 0; i < COUNT(choices); i++) {
        size_t count = 0;
        while (count < 5 && choices[i].values[count])
            count++;
        length += (size_t)snprintf(text + length, text_size - length, "%s=%s ", choices[i].name,
                                   choices[i].values[neph_test_random(seed) % count]);
    }
    return test_settings(text);
}

/* Allowed difference between device and CPU reference when no colour is above `most`. float32
 * rounds about 60 times (16 + 9 taps with their weights, box, blend), each time by up to an ulp in
 * either direction, about 8 ulps in total; twice that is allowed (the largest of a million pixels:
 * 5). Ill-conditioned steps multiply it: the contrast law acts on differences down to taa_contrast
 * of the luma, so it increases their error by 1 / 0.01; the inverse of Reinhard's curve has slope
 * (1 + c)^2. Halves are rounded on both sides, with stochastic rounding by up to a whole step. */
static inline double allowed(const struct neph_gpu_view *view, double expected, double most)
{
    double ulps = 16.0;
    if (view->settings[RT_TAA_CONTRAST] > 0.0f)
        ulps *= 100.0;
    if ((int)view->settings[RT_TAA_SPACE] == RT_SPACE_REINHARD)
        ulps *= 1.0 + most;
    const double step = (int)view->settings[RT_TARGET_FORMAT] == RT_FORMAT_HALF
                            ? fmax(2.0 * half_ulp * fabs(expected) * 1.001, 0x1p-24)
                            : 0.0;
    return ulps * float_ulp * most + step;
}

static inline void compare(struct test_passes *test, double most, uint64_t seed,
                           const char *settings)
{
    uint32_t *words = test_download(test, RT_TAA_OUT);
    const struct neph_gpu_target *shape = &test->view.targets[RT_TAA_OUT];
    for (size_t i = 0; i < test_elements(test, RT_TAA_OUT); i++) {
        float actual[4], expected[4];
        neph_rt_load(shape, words, i, actual);
        test_get(test, RT_TAA_OUT, i, expected);
        for (int c = 0; c < 4; c++) {
            const double scale = c < 3 ? most : fabs((double)expected[c]); /* an age is no colour */
            const double bound = allowed(&test->view, expected[c], scale);
            if (!(fabs((double)actual[c] - (double)expected[c]) <= bound) &&
                !(isnan(actual[c]) && isnan(expected[c]))) /* 0 / 0 without guard */
                fail_msg(
                    "seed %llu, %s: element %zu channel %d is %.9g, %.9g in the CPU reference, "
                    "allowed %.3g",
                    (unsigned long long)seed, settings, i, c, (double)actual[c],
                    (double)expected[c], bound);
        }
    }
    free(words);
}

#endif

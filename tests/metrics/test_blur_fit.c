/* SPDX-License-Identifier: MIT
 *
 * The blur between frames, of frames with a known blur.
 */
#include "tests/neph_test.h"

#include "metrics/blur_fit.h"
#include "metrics/gaussian.h"

enum { WIDTH = 48, HEIGHT = 32, PIXELS = WIDTH * HEIGHT, FRAMES = 3 };

struct frames {
    float sharp[FRAMES][PIXELS], blurred[FRAMES][PIXELS];
};

/* Thin bright and dark lines over noise, blurred by the `blur_px` of each frame. */
static void make_frames(const double blur_px[FRAMES], struct frames *frames)
{
    uint64_t random = 20261129;
    for (int f = 0; f < FRAMES; f++) {
        for (int i = 0; i < PIXELS; i++)
            frames->sharp[f][i] = (float)neph_test_uniform(&random, 0.9, 1.1) +
                                  ((i % WIDTH + f) % 7 == 0 ? 4.0f : 0.0f);
        memcpy(frames->blurred[f], frames->sharp[f], sizeof(frames->sharp[f]));
        if (blur_px[f] > 0.0)
            neph_assert_ok(neph_gaussian_blur(frames->blurred[f], WIDTH, HEIGHT, blur_px[f], NULL),
                           NULL);
    }
}

static double find_blur(const struct frames *frames)
{
    const float *const sharp[FRAMES] = {frames->sharp[0], frames->sharp[1], frames->sharp[2]};
    const float *const blurred[FRAMES] = {frames->blurred[0], frames->blurred[1],
                                          frames->blurred[2]};
    const struct neph_blur_fit fit = {.sharp = sharp,
                                      .blurred = blurred,
                                      .frame_count = FRAMES,
                                      .width_px = WIDTH,
                                      .height_px = HEIGHT};
    double sigma_px = NAN;
    neph_assert_ok(neph_blur_fit_find(&fit, &sigma_px, NULL), NULL);
    return sigma_px;
}

static void test_a_known_blur_is_found(void **state)
{
    static const double blurs_px[] = {0.37, 0.523, 0.7, 1.0, 1.4444, 1.5};
    struct frames frames;
    for (size_t i = 0; i < sizeof(blurs_px) / sizeof(blurs_px[0]); i++) {
        make_frames((const double[]){blurs_px[i], blurs_px[i], blurs_px[i]}, &frames);
        neph_assert_close(find_blur(&frames), blurs_px[i], 0.0, 0.001);
    }
}

/* Noise that is added to the frames, equally often in both directions, is no blur. */
static void test_noise_does_not_move_the_fit(void **state)
{
    struct frames frames;
    uint64_t random = 20261130;
    make_frames((const double[]){0.7, 0.7, 0.7}, &frames);
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < PIXELS; i++)
            frames.blurred[f][i] += (float)neph_test_uniform(&random, -0.1, 0.1);
    neph_assert_close(find_blur(&frames), 0.7, 0.0, 0.01);
}

/* Also of frames with a sharpened edge, which no blur comes closer to. */
static void test_frames_without_blur_have_0(void **state)
{
    struct frames frames;
    make_frames((const double[]){0.0, 0.0, 0.0}, &frames);
    neph_assert_close(find_blur(&frames), 0.0, 0.0, 0.0);
    for (int f = 0; f < FRAMES; f++)
        for (int i = 0; i < PIXELS; i++)
            frames.blurred[f][i] *= frames.sharp[f][i];
    neph_assert_close(find_blur(&frames), 0.0, 0.0, 0.0);
}

/* A number between the blurs of the frames. */
static void test_all_frames_count(void **state)
{
    struct frames frames;
    make_frames((const double[]){0.5, 0.7, 0.9}, &frames);
    neph_assert_close(find_blur(&frames), 0.7, 0.0, 0.06);
    make_frames((const double[]){0.5, 0.9, 0.9}, &frames);
    assert_true(find_blur(&frames) > 0.7);
}

static void test_a_larger_blur_has_the_largest_that_is_searched(void **state)
{
    struct frames frames;
    make_frames((const double[]){2.5, 2.5, 2.5}, &frames);
    neph_assert_close(find_blur(&frames), NEPH_BLUR_FIT_MOST_PX, 0.0, 1e-9);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Sequences of the real-time renderer, frame by frame, and the scene that most of these tests
 * use.
 */
#ifndef NEPH_TESTS_SEQUENCE_TEST_H
#define NEPH_TESTS_SEQUENCE_TEST_H

#include "tests/renderer/frames.h"
#include "tests/renderer/realtime_test.h"

/* A fence in front of the sky, on a ground, in fog: depth edges with different light on both sides.
 * Kernels are specialized for the number of solids. Tests with the same scene share kernels, and
 * compiling kernels is most of a test's time. */
static inline void test_scene_fence(struct test_scene *test)
{
    test_scene_init(test);
    test_add_medium(test, 0.03, 0.05, 0.0);
    for (int i = 0; i < 5; i++)
        test_add_box(test, (struct neph_vec3){-3.0 + 1.4 * i, 0.0, -12.0},
                     (struct neph_vec3){-2.4 + 1.4 * i, 4.0, -11.8});
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
}

static inline struct neph_realtime *test_sequence(struct neph_vulkan *vulkan,
                                                  const struct neph_scene *scene,
                                                  const struct neph_settings *settings,
                                                  int width_px, int height_px)
{
    const struct neph_realtime_params params = {.width_px = width_px,
                                                .height_px = height_px,
                                                .settings = settings,
                                                .seed = 1,
                                                .blue_noise_path = NEPH_SOURCE_DIR
                                                "/renderer/blue_noise.png"};
    struct neph_realtime *realtime = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_realtime_create(vulkan, scene, &params, &realtime, &diag), &diag);
    return realtime;
}

/* Renders the next frame. For neph_image_destroy(). `stats` may be NULL. */
static inline struct neph_image *test_next(struct neph_realtime *realtime,
                                           const struct neph_scene *scene, int frame,
                                           struct neph_realtime_stats *stats)
{
    const struct neph_realtime_frame picture = {scene, frame, NULL};
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_realtime_render(realtime, &picture, &image, stats, &diag), &diag);
    return image;
}

#endif

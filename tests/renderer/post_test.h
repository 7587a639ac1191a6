/* SPDX-License-Identifier: MIT
 *
 * Common part of the post-processing tests: settings from text, and frames to fill.
 */
#ifndef NEPH_TESTS_POST_TEST_H
#define NEPH_TESTS_POST_TEST_H

#include "tests/renderer/renderer_test.h"

#include "renderer/post/chain.h"

/* Default settings, changed by "key=value key=value". */
static inline struct neph_settings post_settings(const char *text)
{
    struct neph_settings settings = neph_options_default(neph_post_options);
    test_assign(neph_post_options, text, &settings);
    return settings;
}

static inline struct neph_image *post_image(int width_px, int height_px, float *rgb[3])
{
    struct neph_image *image;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_image_create(width_px, height_px, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, rgb, &diag), &diag);
    return image;
}

/* One frame through the post-processing chain. */
static inline struct neph_image *post_made(struct neph_vulkan *vulkan, const char *settings,
                                           const struct neph_image *frame, float *rgb[3])
{
    const struct neph_post_params params = {.settings = post_settings(settings)};
    struct neph_diag diag = {0};
    struct neph_image *made;
    neph_assert_ok(neph_post_run(vulkan, &params, frame, &made, NULL, &diag), &diag);
    assert_true(neph_image_rgb(made, NULL, rgb));
    return made;
}

#endif

/* SPDX-License-Identifier: MIT
 *
 * What the tests of the screen share: pictures of small scenes, and what a pixel of them sees, in
 * double precision.
 */
#ifndef NEPH_TESTS_SCREEN_TEST_H
#define NEPH_TESTS_SCREEN_TEST_H

#include "tests/renderer/renderer_test.h"

#include "renderer/screen/screen.h"
#include "scenes/solids.h"

/* Preset `ours` with "ao=gtao ao_steps=8"; NULL: as it is. */
static inline struct neph_settings screen_settings(const char *assignments)
{
    struct neph_diag diag = {0};
    struct neph_settings settings;
    neph_assert_ok(neph_options_preset(neph_screen_options, "the screen", neph_screen_presets,
                                       "ours", &settings, &diag),
                   &diag);
    test_assign(neph_screen_options, assignments ? assignments : "", &settings);
    return settings;
}

static inline struct neph_screening *screen_of(struct neph_vulkan *vulkan,
                                               const struct test_scene *test, int width_px,
                                               int height_px, const char *assignments)
{
    struct neph_diag diag = {0};
    struct neph_screening *screen = NULL;
    const struct neph_screen_params params = {
        .settings = screen_settings(assignments), .width_px = width_px, .height_px = height_px};
    neph_assert_ok(neph_screening_create(vulkan, &test->scene, &params, &screen, &diag), &diag);
    return screen;
}

/* For neph_image_destroy(). */
static inline struct neph_image *screen_next(struct neph_screening *screen,
                                             const struct test_scene *test)
{
    struct neph_diag diag = {0};
    struct neph_image *image = NULL;
    neph_assert_ok(neph_screening_frame(screen, &test->scene, 0.0, &image, NULL, &diag), &diag);
    return image;
}

static inline struct neph_image *screen_picture(struct neph_vulkan *vulkan,
                                                const struct test_scene *test, int width_px,
                                                int height_px, const char *assignments)
{
    struct neph_screening *screen = screen_of(vulkan, test, width_px, height_px, assignments);
    struct neph_image *image = screen_next(screen, test);
    neph_screening_destroy(screen);
    return image;
}

/* What pixel (i, j) sees. */
static inline struct neph_hit screen_hit(const struct test_scene *test, int width_px, int height_px,
                                         int i, int j, struct neph_vec3 *point_m)
{
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, width_px, height_px, i, j);
    const struct neph_hit hit = neph_scene_hit(&test->scene, ray.origin_m, ray.direction);
    *point_m = hit.solid ? neph_vec3_along(ray.origin_m, ray.direction, hit.t_m) : ray.origin_m;
    return hit;
}

#endif

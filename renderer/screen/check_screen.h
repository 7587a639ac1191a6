/* SPDX-License-Identifier: MIT
 *
 * Shared by the tests of the screen: frames of small scenes, and the visible surface of a pixel in
 * double precision.
 */
#ifndef NEPH_SCREEN_CHECK_SCREEN_H
#define NEPH_SCREEN_CHECK_SCREEN_H

#include "tests/renderer/renderer_test.h"

#include "renderer/screen/screen.h"
#include "scenes/solids.h"

/* Preset `ours` with "ao=gtao ao_steps=8"; NULL: unchanged. */
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

static inline struct neph_screen_renderer *create_screen(struct neph_vulkan *vulkan,
                                                         const struct test_scene *test,
                                                         int width_px, int height_px,
                                                         const char *assignments)
{
    struct neph_diag diag = {0};
    struct neph_screen_renderer *screen = NULL;
    const struct neph_screen_params params = {
        .settings = screen_settings(assignments), .width_px = width_px, .height_px = height_px};
    neph_assert_ok(neph_screen_renderer_create(vulkan, &test->scene, &params, &screen, &diag),
                   &diag);
    return screen;
}

/* The caller frees it with neph_image_destroy(). */
static inline struct neph_image *screen_next(struct neph_screen_renderer *screen,
                                             const struct test_scene *test)
{
    struct neph_diag diag = {0};
    struct neph_image *image = NULL;
    neph_assert_ok(neph_screen_renderer_frame(screen, &test->scene, 0.0, &image, NULL, &diag),
                   &diag);
    return image;
}

static inline struct neph_image *screen_picture(struct neph_vulkan *vulkan,
                                                const struct test_scene *test, int width_px,
                                                int height_px, const char *assignments)
{
    struct neph_screen_renderer *screen = create_screen(vulkan, test, width_px, height_px,
                                                        assignments);
    struct neph_image *image = screen_next(screen, test);
    neph_screen_renderer_destroy(screen);
    return image;
}

/* The surface visible at pixel (i, j). */
static inline struct neph_hit screen_hit(const struct test_scene *test, int width_px, int height_px,
                                         int i, int j, struct neph_vec3 *point_m)
{
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    const struct neph_pixel_ray ray = neph_camera_ray(&camera, width_px, height_px, i, j);
    const struct neph_hit hit = neph_scene_hit(&test->scene, ray.origin_m, ray.direction);
    *point_m = hit.solid ? neph_vec3_along(ray.origin_m, ray.direction, hit.t_m) : ray.origin_m;
    return hit;
}

/* The form factor from a plane element to a rectangle perpendicular to the plane, with a lower
 * corner at `distance_m` along its normal (J. R. Howell, "A Catalog of Radiation Heat Transfer
 * Configuration Factors", B-4). */
static inline double standing_rectangle(double distance_m, double width_m, double height_m)
{
    const double slant_m = hypot(distance_m, height_m);
    return (atan(width_m / distance_m) - distance_m / slant_m * atan(width_m / slant_m)) /
           (2.0 * M_PI);
}

/* Four values a pixel, to be freed by the caller. */
static inline float *screen_read(struct neph_screen_renderer *screen, int width_px, int height_px,
                                 int target)
{
    struct neph_diag diag = {0};
    float *texels = malloc(4 * (size_t)width_px * (size_t)height_px * sizeof(*texels));
    neph_assert_ok(neph_screen_renderer_read(screen, target, texels, &diag), &diag);
    return texels;
}

/* Add an omnidirectional light. */
static inline void screen_add_light(struct test_scene *test, struct neph_vec3 position_m)
{
    test->scene.lights[test->scene.light_count++] = (struct neph_light){
        .position_m = position_m,
        .intensity_w_per_sr = {2.0, 1.5, 1.0},
        .axis = {0.0, -1.0, 0.0},
        .inner_cosine = -2.0,
        .outer_cosine = -3.0,
    };
}

#endif

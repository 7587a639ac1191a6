/* SPDX-License-Identifier: MIT
 *
 * What the Vulkan tests share: a device with validation on, of which any message fails the test,
 * and small scenes in memory.
 */
#ifndef NEPH_TESTS_RENDERER_TEST_H
#define NEPH_TESTS_RENDERER_TEST_H

#include "tests/neph_test.h"

#include "renderer/vulkan.h"
#include "scenes/scene.h"

static inline struct neph_vulkan *test_vulkan_open(void)
{
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_vulkan_create(&(struct neph_vulkan_params){.validation = true}, &vulkan, &diag),
        &diag);
    return vulkan;
}

/* cmocka group fixtures. */
static inline int test_vulkan_setup(void **state)
{
    *state = test_vulkan_open();
    return 0;
}

static inline int test_vulkan_teardown(void **state)
{
    struct neph_diag diag = {0};
    if (neph_vulkan_check(*state, &diag))
        print_error("%s\n", diag.message);
    const int message_count = neph_vulkan_destroy(*state);
    if (message_count > 0)
        print_error("%d validation messages\n", message_count);
    return message_count;
}

static const struct neph_bounds test_unbounded = {{-INFINITY, -INFINITY, -INFINITY},
                                                  {INFINITY, INFINITY, INFINITY}};

/* A scene with room for its solids and one camera key; keep it alive while `scene` is used. */
struct test_scene {
    struct neph_scene scene;
    struct neph_camera_key key;
    struct neph_solid solids[16];
};

/* No media, no solids; the camera at 1.6 m looks down -Z; sun at 40 degrees, ahead and right. */
static inline void test_scene_init(struct test_scene *test)
{
    memset(test, 0, sizeof(*test));
    struct neph_scene *scene = &test->scene;
    test->key.position_m = (struct neph_vec3){0.0, 1.6, 0.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 1.6, -10.0};
    scene->camera_key_count = 1;
    scene->camera_keys = &test->key;
    scene->camera_up = (struct neph_vec3){0.0, 1.0, 0.0};
    scene->vertical_fov_rad = 0.9;
    scene->frame_count = 1;
    scene->frame_rate_hz = 30.0;
    scene->sun.present = true;
    scene->sun.direction = neph_vec3_normalize((struct neph_vec3){0.5, 0.7, -0.6});
    scene->sun.irradiance_w_per_m2 = (struct neph_rgb){10.0, 9.0, 8.0};
    scene->background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.4};
    scene->scattering = NEPH_SCATTERING_SINGLE;
    scene->solids = test->solids;
}

static inline struct neph_medium *test_add_medium(struct test_scene *test, double extinction_per_m,
                                                  double falloff_per_m, double height_m)
{
    struct neph_medium *medium = &test->scene.media[test->scene.medium_count++];
    *medium = (struct neph_medium){
        .kind = falloff_per_m > 0.0 ? NEPH_MEDIUM_HEIGHT_FOG : NEPH_MEDIUM_HOMOGENEOUS,
        .bounds = test_unbounded,
        .albedo = {0.9, 0.8, 0.7},
        .phase = {.kind = NEPH_PHASE_HENYEY_GREENSTEIN, .g = 0.4},
        .layer_count = 1,
        .extinction_color = {1, 1, 1},
        .layers = {{extinction_per_m, falloff_per_m, height_m}},
    };
    return medium;
}

static inline void test_add_layer(struct neph_medium *medium, double extinction_per_m,
                                  double falloff_per_m, double height_m)
{
    medium->layers[medium->layer_count++] = (struct neph_fog_layer){extinction_per_m, falloff_per_m,
                                                                    height_m};
}

static inline void test_add_box(struct test_scene *test, struct neph_vec3 min_m,
                                struct neph_vec3 max_m)
{
    test->solids[test->scene.solid_count++] = (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = {min_m, max_m}, .albedo = {0.5, 0.4, 0.3}};
}

static inline void test_add_sphere(struct test_scene *test, struct neph_vec3 center_m,
                                   double radius_m)
{
    test->solids[test->scene.solid_count++] = (struct neph_solid){.kind = NEPH_SOLID_SPHERE,
                                                                  .center_m = center_m,
                                                                  .radius_m = radius_m,
                                                                  .albedo = {0.5, 0.4, 0.3}};
}

#endif

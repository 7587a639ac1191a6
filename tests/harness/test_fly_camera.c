/* SPDX-License-Identifier: MIT
 *
 * The camera of `neph fly`: movement, speed, collisions.
 */
#include "tests/neph_test.h"

#include "harness/fly/camera.h"

#include <float.h>

/* Rounding of rotations and sums of a few terms of size 10. */
#define ROUNDING (64.0 * DBL_EPSILON)

static struct neph_camera_key start = {.position_m = {0, 2, 0}, .look_at_m = {0, 2, -10}};

static struct neph_scene make_scene(void)
{
    return (struct neph_scene){.camera_key_count = 1,
                               .camera_keys = &start,
                               .camera_up = {0, 1, 0},
                               .vertical_fov_rad = 1.0};
}

static void assert_vector(struct neph_vec3 actual, double x, double y, double z)
{
    neph_assert_close(actual.x, x, 0.0, 10.0 * ROUNDING);
    neph_assert_close(actual.y, y, 0.0, 10.0 * ROUNDING);
    neph_assert_close(actual.z, z, 0.0, 10.0 * ROUNDING);
}

static const struct neph_fly_motion at_rest = {.speed_factor = 1.0, .time_s = 0.5};

static void test_a_static_camera_keeps_its_bits(void **state)
{
    struct neph_scene scene = make_scene();
    struct neph_camera_key odd = {.position_m = {0.1, 0.2, 0.3}, .look_at_m = {1e3, 0.7, -1e-3}};
    scene.camera_keys = &odd;
    struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
    assert_true(neph_fly_is_same_view(&camera.key, &odd));
    neph_fly_camera_move(&camera, &scene, &at_rest);
    assert_true(neph_fly_is_same_view(&camera.key, &odd));
}

static void test_each_way_is_an_axis_of_the_view(void **state)
{
    static const struct {
        double right, up, forward;
        double x, y, z; /* after half a second at 5 m/s from the start */
    } cases[] = {{1, 0, 0, 2.5, 2, 0},   {-1, 0, 0, -2.5, 2, 0}, {0, 1, 0, 0, 4.5, 0},
                 {0, -1, 0, 0, -0.5, 0}, {0, 0, 1, 0, 2, -2.5},  {0, 0, -1, 0, 2, 2.5},
                 {4, 0, 0, 10, 2, 0}};
    const struct neph_scene scene = make_scene();
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
        struct neph_fly_motion motion = at_rest;
        motion.right = cases[i].right;
        motion.up = cases[i].up;
        motion.forward = cases[i].forward;
        neph_fly_camera_move(&camera, &scene, &motion);
        assert_vector(camera.key.position_m, cases[i].x, cases[i].y, cases[i].z);
        assert_vector(neph_vec3_sub(camera.key.look_at_m, camera.key.position_m), 0, 0, -10);
    }
}

static void test_it_turns_right_and_up_about_where_it_stands(void **state)
{
    const struct neph_scene scene = make_scene();
    struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
    struct neph_fly_motion motion = at_rest;
    motion.turn_right_rad = 0.5 * M_PI;
    neph_fly_camera_move(&camera, &scene, &motion);
    assert_vector(camera.key.position_m, 0, 2, 0);
    assert_vector(camera.key.look_at_m, 10, 2, 0);
    motion.turn_right_rad = 0.0;
    motion.turn_up_rad = M_PI / 6.0;
    neph_fly_camera_move(&camera, &scene, &motion);
    assert_vector(camera.key.look_at_m, 10.0 * cos(M_PI / 6.0), 2.0 + 10.0 * sin(M_PI / 6.0), 0);
}

static void test_pitch_is_limited(void **state)
{
    const struct neph_scene scene = make_scene();
    struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
    struct neph_fly_motion motion = at_rest;
    motion.turn_up_rad = 3.0;
    neph_fly_camera_move(&camera, &scene, &motion);
    const double limit_rad = 89.0 * NEPH_RAD_PER_DEG;
    assert_vector(camera.key.look_at_m, 0, 2.0 + 10.0 * sin(limit_rad), -10.0 * cos(limit_rad));
}

static void test_solids_are_not_entered(void **state)
{
    struct neph_solid solids[] = {
        {.kind = NEPH_SOLID_BOX, .box = {{-1, 0, -3}, {1, 4, -2}}},
        {.kind = NEPH_SOLID_SPHERE, .center_m = {5, 2, 0}, .radius_m = 3.0},
    };
    struct neph_scene scene = make_scene();
    scene.solids = solids;
    scene.solid_count = 2;
    struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
    struct neph_fly_motion motion = at_rest;
    motion.forward = 1.0; /* to z = -2.5, in the box */
    neph_fly_camera_move(&camera, &scene, &motion);
    assert_vector(camera.key.position_m, 0, 2, 0);
    motion.forward = 0.0;
    motion.right = 1.0; /* to x = 2.5, in the ball */
    motion.turn_right_rad = 0.1;
    neph_fly_camera_move(&camera, &scene, &motion);
    assert_vector(camera.key.position_m, 0, 2, 0);
    assert_true(camera.key.look_at_m.x > 0.5); /* it turns nevertheless */
}

static void test_it_stays_where_a_scene_file_may_put_it(void **state)
{
    const struct neph_scene scene = make_scene();
    struct neph_fly_camera camera = neph_fly_camera_from_scene(&scene);
    struct neph_fly_motion motion = at_rest;
    motion.forward = 1.0;
    motion.speed_factor = 1e9;
    for (int i = 0; i < 100; i++)
        neph_fly_camera_move(&camera, &scene, &motion);
    assert_true(camera.key.look_at_m.z < -9e5 && camera.key.look_at_m.z >= -1e6);
}

/* Two seconds to the nearest visible object. */
static void test_speed_follows_the_scene(void **state)
{
    struct neph_scene scene = make_scene();
    scene.medium_count = 1;
    scene.media[0].bounds = (struct neph_bounds){{-INFINITY, -INFINITY, -INFINITY},
                                                 {INFINITY, INFINITY, INFINITY}};
    neph_assert_close(neph_fly_camera_from_scene(&scene).speed_m_per_s, 5.0, ROUNDING, 0.0);
    scene.media[0].bounds = (struct neph_bounds){{-1e4, 80, -1e4}, {1e4, 360, 1e4}}; /* above it */
    neph_assert_close(neph_fly_camera_from_scene(&scene).speed_m_per_s, 39.0, ROUNDING, 0.0);
    scene.media[0].bounds = (struct neph_bounds){{-1e4, 0, -1e4}, {1e4, 280, 1e4}}; /* around it */
    neph_assert_close(neph_fly_camera_from_scene(&scene).speed_m_per_s, 140.0, ROUNDING, 0.0);
    scene.media[0].bounds = (struct neph_bounds){{-1, 0, -4}, {1, 4, -2}}; /* before the target */
    neph_assert_close(neph_fly_camera_from_scene(&scene).speed_m_per_s, 5.0, ROUNDING, 0.0);
}

#include "tests/main.h"

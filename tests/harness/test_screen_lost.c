/* SPDX-License-Identifier: MIT
 *
 * Why a screen-space method misses light: a wall that is partly outside of the frame, a screen
 * between camera and wall, a post that hides nothing.
 */
#include "tests/scene_builders.h"

#include "harness/study/screen_lost.h"

enum { SIDE = 64, RAYS = 4096 };

/* An orthographic camera looks along -z from above: its frame is 4 m wide, with sides at the planes
 * x = -2 and x = 2. */
static void set_ground(struct test_scene *test)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.0, 10.0, 10.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 0.0, 0.0};
    test->scene.vertical_fov_rad = 0.0;
    test->scene.orthographic_height_m = 4.0;
    test_add_box(test, (struct neph_vec3){-50, -1, -50}, (struct neph_vec3){50, 0, 50});
}

/* Evaluates the pixel that shows a given point of the ground. */
static void evaluate_from(const struct test_scene *test, double x_m, double z_m, double reach_m,
                          double shares[NEPH_SCREEN_LOSSES])
{
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    const struct neph_vec3 way_m = neph_vec3_sub((struct neph_vec3){x_m, 0.0, z_m},
                                                 camera.position_m);
    const int column = (int)((0.5 + neph_vec3_dot(way_m, camera.right) / 4.0) * SIDE);
    const int row = (int)((0.5 - neph_vec3_dot(way_m, camera.up) / 4.0) * SIDE);
    neph_screen_compute_lost_shares(&test->scene, &camera, SIDE, SIDE, column, row, reach_m, RAYS,
                                    shares);
}

/* The form factor of a rectangle that stands on a plane, from x = 0 to a width (J. R. Howell, "A
 * Catalog of Radiation Heat Transfer Configuration Factors", B-4). */
static double standing_rectangle(double distance_m, double width_m, double height_m)
{
    const double slant_m = hypot(distance_m, height_m);
    return (atan(width_m / distance_m) - distance_m / slant_m * atan(width_m / slant_m)) /
           (2.0 * M_PI);
}

/* The ground sees the wall from x = 1.5 to 7; the part beyond 2 is outside of the frame. Half a
 * pixel is 3 cm. */
static void test_a_wall_beyond_the_frame(void **state)
{
    struct test_scene test;
    double shares[NEPH_SCREEN_LOSSES];
    set_ground(&test);
    test_add_box(&test, (struct neph_vec3){1.5, 0, -1.2}, (struct neph_vec3){7, 1, -1});
    evaluate_from(&test, 1.0, 0.0, INFINITY, shares);
    const double off = standing_rectangle(1.0, 6.0, 1.0) - standing_rectangle(1.0, 1.0, 1.0);
    neph_assert_close(shares[NEPH_LOST_OFF], off, 0.06, 0.002);
    neph_assert_close(shares[NEPH_LOST_BEHIND], 0.0, 0.0, 0.002);
    neph_assert_close(shares[NEPH_LOST_THIN], 0.0, 0.0,
                      0.01); /* rays past its near end, and behind it */
    evaluate_from(&test, 1.0, 0.0, 1.2,
                  shares); /* the part outside of the frame begins 1.4 m away */
    assert_true(shares[NEPH_LOST_OFF] == 0.0);
}

/* A plate above the ground. From below, rays hit its lower side, which the camera does not see.
 * From the side, rays go behind its edge and hit the lower side, or pass. */
static void test_a_plate_over_the_ground(void **state)
{
    struct test_scene test;
    double shares[NEPH_SCREEN_LOSSES];
    set_ground(&test);
    test_add_box(&test, (struct neph_vec3){-1, 0.5, -0.5}, (struct neph_vec3){1, 0.52, 0.5});
    evaluate_from(&test, 0.0, 0.9, INFINITY, shares);
    assert_true(shares[NEPH_LOST_BEHIND] > 0.05 && shares[NEPH_LOST_OFF] == 0.0);
    assert_true(shares[NEPH_LOST_THIN] > 0.005);
    evaluate_from(&test, 0.0, 0.9, 0.3, shares); /* the plate is farther away */
    for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
        neph_assert_close(shares[i], 0.0, 0.0, 1e-9);
}

/* A convex body loses no light to itself, and open ground loses none. */
static void test_a_ball_and_the_ground(void **state)
{
    struct test_scene test;
    double shares[NEPH_SCREEN_LOSSES];
    set_ground(&test);
    evaluate_from(&test, 0.7, -0.3, INFINITY, shares);
    for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
        assert_true(shares[i] == 0.0);
    test_add_sphere(&test, (struct neph_vec3){0, 0.5, 0}, 0.5);
    evaluate_from(&test, -1.6, 0.0, INFINITY, shares); /* half of the ball, seen from the side */
    assert_true(shares[NEPH_LOST_BEHIND] > 0.0 && shares[NEPH_LOST_OFF] == 0.0);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * The scenes of scenes/stress match their descriptions, pixel by pixel at 320x180 and ray by ray at
 * half and quarter of this size.
 */
#include "tests/neph_test.h"

#include "scenes/motion.h"
#include "scenes/solids.h"

enum { WIDTH = 320, HEIGHT = 180 };

static struct neph_scene *load(const char *name)
{
    char path[512];
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene = NULL;
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/stress/%s.yaml", name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

/* Eye depth at a pixel of a frame that is `divisor` times smaller; +inf in the sky. */
static double depth_m(const struct neph_scene *scene, int divisor, int x, int y)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    const struct neph_vec3 ray =
        neph_camera_ray(&camera, WIDTH / divisor, HEIGHT / divisor, x, y).direction;
    return neph_scene_hit(scene, camera.position_m, ray).t_m * neph_vec3_dot(ray, camera.forward);
}

/* Below row `top`, bars are in the columns with a '#' in the pattern, which repeats. */
static void assert_fence(const struct neph_scene *scene, int divisor, int top, const char *pattern)
{
    for (int y = 0; y < HEIGHT / divisor; y++)
        for (int x = 0; x < WIDTH / divisor; x++) {
            const bool bar = y >= top && pattern[(size_t)x % strlen(pattern)] == '#';
            neph_assert_close(depth_m(scene, divisor, x, y), bar ? 10.0 : INFINITY, 1e-12, 0.0);
        }
}

static void test_fences_have_their_pitch(void **state)
{
    struct neph_scene *scene = load("fence_pitch4");
    assert_fence(scene, 1, 55, ".##.");
    assert_fence(scene, 2, 27, ".#");
    assert_fence(scene, 4, 14, "#");
    neph_scene_destroy(scene);
    scene = load("sun_step");
    assert_fence(scene, 1, 55, "...#....");
    neph_scene_destroy(scene);
}

static void test_leaves_are_pixels(void **state)
{
    struct neph_scene *scene = load("foliage");
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const double z_m = depth_m(scene, 1, x, y);
            if (isinf(z_m))
                continue;
            count++;
            assert_true(x >= 110 && x < 210 && y >= 65 && y < 115);
            neph_assert_close(z_m, round(z_m), 1e-12, 0.0); /* faces, no sides */
        }
    assert_int_equal(count, scene->solid_count);
    assert_int_equal(count, 500);
    neph_scene_destroy(scene);
}

static void test_ridges_are_20_pixels_apart(void **state)
{
    struct neph_scene *scene = load("ridges");
    static const double at_m[] = {30000, 15100, 14900, 12000, 9000, 9000};
    for (int y = 0; y < HEIGHT; y++)
        neph_assert_close(depth_m(scene, 1, 7 * y % WIDTH, y),
                          y < 70 ? INFINITY : at_m[(y - 70) / 20], 1e-12, 0.0);
    neph_scene_destroy(scene);
}

/* The sun is in the plane of fences, walls and leaves: no shadow falls next to it, and no light on
 * faces towards -Z. */
static void test_sun_grazes_all_faces(void **state)
{
    static const char *const names[] = {"fence_pitch4", "sun_step",   "foliage",
                                        "ridges",       "camera_pan", "camera_cut"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_scene *scene = load(names[i]);
        for (int frame = 0; frame < scene->frame_count; frame++)
            assert_true(neph_scene_sun(scene, frame).direction.z == 0.0);
        neph_scene_destroy(scene);
    }
}

static void test_sun_steps_at_frame_64(void **state)
{
    struct neph_scene *scene = load("sun_step");
    assert_int_equal(scene->frame_count, 128);
    const double x = 0.95 / sqrt(0.95 * 0.95 + 0.3 * 0.3);
    for (int frame = 0; frame < 128; frame++)
        neph_assert_close(neph_scene_sun(scene, frame).direction.x, frame < 64 ? x : -x, 1e-15,
                          0.0);
    neph_scene_destroy(scene);
}

static void test_wind_is_two_pixels_per_frame(void **state)
{
    struct neph_scene *scene = load("wind_cloud");
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    const double pixel_m = 2.0 * tan(0.5 * camera.vertical_fov_rad) / HEIGHT * 40.0;
    assert_true(scene->media[1].gaussian.center_m.z == -40.0);
    for (int frame = 0; frame < scene->frame_count; frame++)
        neph_assert_close(neph_scene_wind_displacement_m(scene, frame).x, 2.0 * frame * pixel_m,
                          1e-14, 0.0);
    neph_scene_destroy(scene);
}

/* The scene's description: 1e-5 rad. */
static void test_pan_is_even(void **state)
{
    struct neph_scene *scene = load("camera_pan");
    for (int frame = 0; frame < scene->frame_count; frame++) {
        const struct neph_vec3 forward = neph_scene_camera(scene, frame).forward;
        neph_assert_close(atan2(forward.x, -forward.z), (frame - 32) * M_PI / 180.0, 0.0, 1e-5);
    }
    neph_scene_destroy(scene);
}

static void test_camera_cuts_once(void **state)
{
    struct neph_scene *scene = load("camera_cut");
    const struct neph_vec3 before_m = neph_scene_camera(scene, 0).position_m;
    const struct neph_vec3 after_m = neph_scene_camera(scene, 32).position_m;
    assert_true(neph_vec3_length(neph_vec3_sub(after_m, before_m)) > 10.0);
    for (int frame = 1; frame < scene->frame_count; frame++) {
        const double x_m = neph_scene_camera(scene, frame).position_m.x;
        assert_true(x_m == (frame < 32 ? before_m.x : after_m.x));
        assert_int_equal(neph_scene_is_cut(scene, frame - 1, frame), frame == 32);
    }
    neph_scene_destroy(scene);
}

/* The moving scenes of flicker studies move in each of their 256 frames. */
static void test_moving_scenes_never_stop(void **state)
{
    static const char *const names[] = {"pillars_strafe", "lattice_drift", "veil_tower",
                                        "sun_turns",      "orbit_cloud",   "wires_pan"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_scene *scene = load(names[i]);
        assert_int_equal(scene->frame_count, 256);
        for (int frame = 1; frame < scene->frame_count; frame++)
            assert_false(neph_scene_are_frames_equal(scene, frame - 1, frame));
        neph_scene_destroy(scene);
    }
}

/* The speeds in their descriptions, in pixels at 320x180. */
static void test_speeds_are_those_of_the_texts(void **state)
{
    static const double pixel = 0.004; /* of the distance */
    static const struct {
        const char *name;
        double distance_m, px_per_frame;
    } strafes[] = {
        {"pillars_strafe", 6.0, 1.3}, {"pillars_strafe", 25.0, 0.3}, {"veil_tower", 59.0, 0.5}};
    for (size_t i = 0; i < sizeof(strafes) / sizeof(strafes[0]); i++) {
        struct neph_scene *scene = load(strafes[i].name);
        const double moved_m = neph_vec3_length(neph_vec3_sub(
            neph_scene_camera(scene, 101).position_m, neph_scene_camera(scene, 100).position_m));
        neph_assert_close(moved_m / (strafes[i].distance_m * pixel), strafes[i].px_per_frame, 0.0,
                          0.05);
        neph_scene_destroy(scene);
    }
    struct neph_scene *scene = load("lattice_drift");
    neph_assert_close(neph_scene_wind_displacement_m(scene, 1).x / (40.0 * pixel), 0.35, 1e-9, 0.0);
    neph_scene_destroy(scene);
    scene = load("wires_pan");
    const struct neph_vec3 a = neph_scene_camera(scene, 40).forward;
    const struct neph_vec3 b = neph_scene_camera(scene, 41).forward;
    neph_assert_close(acos(neph_vec3_dot(a, b)) / pixel, 0.22, 0.0, 0.005);
    neph_scene_destroy(scene);
}

/* The scenes of a person, a hand and the wind: one pixel of 96x54 is 0.004 of the distance. */

static void test_a_walk_has_its_steps(void **state)
{
    struct neph_scene *scene = load("walk_bob");
    double lift_m = 0.0, sway_m = 0.0;
    for (int frame = 0; frame <= 32; frame += 2) {
        const struct neph_vec3 place_m = neph_scene_camera(scene, frame).position_m;
        neph_assert_close(place_m.z, 2.0 - 1.4 * frame / 30.0, 0.0, 1e-4);
        neph_assert_close(place_m.y, 1.7 + 0.03 * sin(2.0 * M_PI * 1.8 * frame / 30.0), 0.0, 1e-4);
        lift_m = fmax(lift_m, fabs(place_m.y - 1.7));
        sway_m = fmax(sway_m, fabs(place_m.x));
    }
    neph_assert_close(lift_m, 0.03, 0.0, 0.001);
    neph_assert_close(sway_m, 0.018, 0.0, 0.001);
    neph_scene_destroy(scene);
}

/* It moves in each frame, by 0.6 pixels at most, and turns back several times. */
static void test_a_hand_shakes_by_parts_of_a_pixel(void **state)
{
    struct neph_scene *scene = load("hand_shake");
    double before_px = 0.0, most_px = 0.0, farthest_px = 0.0;
    int returns = 0;
    for (int frame = 1; frame <= 32; frame++) {
        const struct neph_vec3 a = neph_scene_camera(scene, frame - 1).forward;
        const struct neph_vec3 b = neph_scene_camera(scene, frame).forward;
        const double moved_px = (b.x - a.x) / 0.004;
        assert_false(neph_scene_are_frames_equal(scene, frame - 1, frame));
        returns += moved_px * before_px < 0.0;
        most_px = fmax(most_px, hypot(moved_px, (b.y - a.y) / 0.004));
        farthest_px = fmax(farthest_px, hypot(b.x, b.y) / 0.004);
        before_px = moved_px;
    }
    assert_true(returns >= 6);
    assert_true(most_px > 0.3 && most_px < 0.6);
    assert_true(farthest_px > 0.8 && farthest_px < 1.5);
    neph_scene_destroy(scene);
}

static void test_winds_behind_leaves_and_wires(void **state)
{
    static const struct {
        const char *name;
        double px_per_frame;
    } winds[] = {{"leaves_gale", 2.0}, {"wires_gale", 2.5}};
    for (size_t i = 0; i < sizeof(winds) / sizeof(winds[0]); i++) {
        struct neph_scene *scene = load(winds[i].name);
        for (int frame = 0; frame < scene->frame_count; frame++)
            neph_assert_close(neph_scene_wind_displacement_m(scene, frame).x / (0.004 * 30.0),
                              winds[i].px_per_frame * frame, 1e-12, 0.0);
        neph_scene_destroy(scene);
    }
}

static void test_a_ride_moves_all_at_once(void **state)
{
    struct neph_scene *scene = load("ride_all");
    for (int frame = 1; frame < scene->frame_count; frame++) {
        const double elevation_deg = asin(neph_scene_sun(scene, frame).direction.y) * 180.0 / M_PI;
        neph_assert_close(neph_scene_camera(scene, frame).position_m.z, 4.0 - 0.2 * frame, 1e-12,
                          0.0);
        neph_assert_close(neph_scene_wind_displacement_m(scene, frame).x, 0.4 * frame, 1e-12, 0.0);
        neph_assert_close(elevation_deg, 35.0 - 0.3 * frame, 0.0, 0.01);
    }
    neph_scene_destroy(scene);
}

#include "tests/main.h"

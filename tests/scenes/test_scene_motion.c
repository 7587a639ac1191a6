/* SPDX-License-Identifier: MIT
 *
 * A scene over time: keys, cuts, pauses and sizes against closed forms, and equality of the static
 * copy at one frame with the moving scene at this frame.
 */
#include "tests/neph_test.h"

#include "base/files.h"
#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "scenes/motion.h"

static const char head[] = "name: probe\n"
                           "title: a probe\n"
                           "physics: none\n"
                           "scattering: single\n";
static const char camera[] =
    "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n";
static const char sun[] = "sun: {direction: [0, 2, 0], irradiance_w_per_m2: [3, 3, 3]}\n";

/* The scene of a file with these keys below `head`. */
static struct neph_scene *load(const char *keys)
{
    char folder[] = "/tmp/neph-motion-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml"), *text = neph_format("%s%s", head, keys);
    assert_int_equal(neph_file_write(path, text, strlen(text), NULL), NEPH_OK);
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    free(text);
    free(path);
    neph_dir_remove(folder, NULL);
    return scene;
}

static struct neph_scene *load_three(const char *a, const char *b, const char *c)
{
    char *keys = neph_format("%s%s%s", a, b, c);
    struct neph_scene *scene = load(keys);
    free(keys);
    return scene;
}

static void assert_vec3(struct neph_vec3 actual, struct neph_vec3 expected, double relative,
                        double absolute)
{
    neph_assert_close(actual.x, expected.x, relative, absolute);
    neph_assert_close(actual.y, expected.y, relative, absolute);
    neph_assert_close(actual.z, expected.z, relative, absolute);
}

/* --- frames and keys ------------------------------------------------------------------------- */

static void test_time_stands_still_in_pauses(void **state)
{
    struct neph_scene *scene = load_three(
        camera, sun, "frames: {pauses: [{frame: 10, count: 60}, {frame: 20, count: 5}]}\n");
    static const double map[][2] = {
        {-3, -3}, {0, 0},   {9.5, 9.5}, {10, 10}, {10.5, 10},   {40, 10}, {70, 10},
        {71, 11}, {79, 19}, {80, 20},   {85, 20}, {85.5, 20.5}, {86, 21}, {165, 100},
    };
    for (size_t i = 0; i < sizeof(map) / sizeof(map[0]); i++)
        assert_true(neph_scene_time_frame(scene, map[i][0]) == map[i][1]);
    neph_scene_destroy(scene);
}

static void test_time_goes_on_unevenly(void **state)
{
    struct neph_scene *scene = load_three(camera, sun, "frames: {advance: [0.25, 2, 0]}\n");
    static const double map[][2] = {
        {-3, -3}, {0, 0},   {1, 0.25},    {1.5, 1.25}, {2, 2.25},   {3, 2.25},       {4, 2.5},
        {5, 4.5}, {6, 4.5}, {6.5, 4.625}, {30, 22.5},  {31, 22.75}, {3001, 2250.25},
    };
    for (size_t i = 0; i < sizeof(map) / sizeof(map[0]); i++)
        assert_true(neph_scene_time_frame(scene, map[i][0]) == map[i][1]);
    neph_scene_destroy(scene);
}

static void test_there_are_no_media_where_they_are_cleared(void **state)
{
    struct neph_scene *scene = load_three(
        camera, sun,
        "frames: {advance: [2], clear: [{frame: 6, count: 3}, {frame: 20, count: 1}]}\n"
        "media: [{gaussian: {center_m: [0, 1, 0], width_m: 1, extinction_per_m: 1,\n"
        "                    albedo: [1, 1, 1]}}]\n");
    for (int picture = -2; picture < 14; picture++) { /* key frames 6 and 8; 20 */
        const bool expected = picture == 3 || picture == 4 || picture == 10;
        struct neph_scene *still = NULL;
        struct neph_diag diag = {.line = 0};
        neph_assert_ok(neph_scene_at(scene, picture, &still, &diag), &diag);
        assert_int_equal(neph_scene_is_clear(scene, picture), expected);
        assert_int_equal(still->medium_count, expected ? 0 : 1);
        assert_false(neph_scene_is_clear(still, picture));
        neph_scene_destroy(still);
    }
    assert_true(neph_scene_moves(scene));
    assert_false(neph_scene_are_frames_equal(scene, 2, 3));
    assert_true(neph_scene_are_frames_equal(scene, 3, 4));
    neph_scene_destroy(scene);
}

static void test_sizes_apply_from_their_frame_on(void **state)
{
    struct neph_scene *scene = load_three(camera, sun,
                                          "frames: {pauses: [{frame: 0, count: 100}],\n"
                                          "         sizes: [{frame: 4, scale: 0.5}, {frame: 6, "
                                          "scale: 0.05}, {frame: 9, scale: 4}]}\n");
    static const int sizes[][3] = {{-1, 321, 7}, {3, 321, 7}, {4, 161, 4},  {5, 161, 4},
                                   {6, 16, 1},   {8, 16, 1},  {9, 1284, 28}};
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        int width_px = 321, height_px = 7; /* 160.5 and 3.5 are rounded up; 0.35 is one pixel */
        neph_scene_frame_size(scene, sizes[i][0], &width_px, &height_px);
        assert_int_equal(width_px, sizes[i][1]);
        assert_int_equal(height_px, sizes[i][2]);
    }
    neph_scene_destroy(scene);
}

/* --- camera ---------------------------------------------------------------------------------- */

static const char cut_camera[] =
    "camera:\n"
    "  vertical_fov_deg: 40\n"
    "  keys:\n"
    "    - {frame: 0, position_m: [0.1, 1, 5], look_at_m: [0.3, 1, 0]}\n"
    "    - {frame: 4, position_m: [0.7, 1, 5], look_at_m: [0.9, 1, 0]}\n"
    "    - {frame: 8, position_m: [7, 1, 5], look_at_m: [9, 1, 0], cut: true}\n"
    "    - {frame: 12, position_m: [8, 1, 5], look_at_m: [9, 1, 0], cut: false}\n";

static void test_camera_is_constant_until_it_cuts(void **state)
{
    struct neph_scene *scene = load_three(cut_camera, sun, "");
    assert_true(neph_scene_camera(scene, -2).position_m.x == 0.1);
    neph_assert_close(neph_scene_camera(scene, 2).position_m.x, 0.4, 1e-15, 0.0);
    const struct neph_camera before = neph_scene_camera(scene, 4);
    for (double frame = 4; frame < 8; frame += 0.37) {
        const struct neph_camera held = neph_scene_camera(scene, frame);
        assert_memory_equal(&held, &before, sizeof(held)); /* to the last bit: nothing moves */
    }
    assert_true(neph_scene_camera(scene, 8).position_m.x == 7);
    neph_assert_close(neph_scene_camera(scene, 10).position_m.x, 7.5, 1e-15, 0.0);
    neph_scene_destroy(scene);
}

static void test_cuts_are_after_the_earlier_frame(void **state)
{
    struct neph_scene *scene = load_three(cut_camera, sun,
                                          "frames: {pauses: [{frame: 8, count: 10}]}\n");
    assert_true(neph_scene_is_cut(scene, 7, 8));
    assert_true(neph_scene_is_cut(scene, 8, 7));
    assert_true(neph_scene_is_cut(scene, 0, 30));
    assert_true(neph_scene_is_cut(scene, 7.75, 8.25));
    assert_false(neph_scene_is_cut(scene, 3, 4)); /* a key without a cut */
    assert_false(neph_scene_is_cut(scene, 8, 8));
    assert_false(neph_scene_is_cut(scene, 8, 9)); /* paused at the cut, which is in the past */
    assert_false(neph_scene_is_cut(scene, 18, 19));
    neph_scene_destroy(scene);
}

/* --- sun ------------------------------------------------------------------------------------- */

static void test_sun_goes_along_the_great_circle(void **state)
{
    struct neph_scene *scene = load_three(
        camera,
        "sun:\n"
        "  keys:\n"
        "    - {frame: 2, direction: [5, 0, 0], irradiance_w_per_m2: [1, 2, 3]}\n"
        "    - {frame: 6, direction: [-0.5, 0.8660254037844386, 0], irradiance_w_per_m2: [3, 2, "
        "0]}\n"
        "    - {frame: 7, direction: [-1, 1e-5, 0], irradiance_w_per_m2: [3, 2, 0]}\n"
        "    - {frame: 9, direction: [-1, 1.000000001e-5, 0], irradiance_w_per_m2: [3, 2, 0]}\n",
        "frames: {pauses: [{frame: 3, count: 5}]}\n");
    const double degree = M_PI / 180.0;
    static const double angles[][2] = {/* frame, degrees from the first key: 120 in 4 frames */
                                       {0, 0},  {2, 0},    {3, 30},   {8, 30},
                                       {9, 60}, {9.5, 75}, {11, 120}, {20, 180 - 5.73e-4}};
    for (size_t i = 0; i < sizeof(angles) / sizeof(angles[0]); i++) {
        const struct neph_sun now = neph_scene_sun(scene, angles[i][0]);
        const double angle = angles[i][1] * degree;
        /* 1e-15: some roundings of unit vectors; the last angle was written with three digits */
        assert_vec3(now.direction, (struct neph_vec3){cos(angle), sin(angle), 0}, 0.0,
                    i == 7 ? 1e-8 : 2e-15);
        neph_assert_close(neph_vec3_length(now.direction), 1.0, 1e-15, 0.0);
    }
    const struct neph_sun half = neph_scene_sun(scene, 9);
    neph_assert_close(half.irradiance_w_per_m2.r, 2.0, 1e-15, 0.0);
    neph_assert_close(half.irradiance_w_per_m2.g, 2.0, 1e-15, 0.0);
    neph_assert_close(half.irradiance_w_per_m2.b, 1.5, 1e-15, 0.0);
    /* 1e-14 rad apart: practically linear */
    const struct neph_sun close = neph_scene_sun(scene, 8 + 5);
    neph_assert_close(close.direction.y / -close.direction.x, 1.0000000005e-5, 1e-11, 0.0);
    /* The scene's own sun is the sun of frame 0. */
    assert_true(scene->sun.present && scene->sun.direction.x == 1.0);
    neph_scene_destroy(scene);
}

/* --- wind ------------------------------------------------------------------------------------ */

#define OPTICS "extinction_per_m: 2, albedo: [1, 1, 1]"
static const char blob[] = "media:\n  - gaussian: {center_m: [0, 1, 0], width_m: 0.5, " OPTICS
                           "}\n";

static void test_steady_wind_is_a_product(void **state)
{
    struct neph_scene *scene = load_three(
        camera, blob, "frames: {rate_hz: 25}\nwind: {velocity_m_per_s: [10, 0.5, -3]}\n");
    for (int frame = -50; frame <= 100; frame += 25) {
        const double s = frame / 25;
        assert_vec3(neph_scene_wind_displacement_m(scene, frame),
                    (struct neph_vec3){10 * s, 0.5 * s, -3 * s}, 1e-15, 0.0);
    }
    assert_vec3(neph_scene_wind_displacement_m(scene, 0), (struct neph_vec3){0, 0, 0}, 0.0, 0.0);
    neph_scene_destroy(scene);
}

/* Velocity 6 until frame 2, then down to -2 at frame 6, then up to 0 at frame 7 and no wind: by the
 * areas under the curve. */
static void test_displacement_is_the_integral(void **state)
{
    struct neph_scene *scene = load_three(camera, blob,
                                          "frames: {rate_hz: 2, pauses: [{frame: 4, count: 3}]}\n"
                                          "wind:\n"
                                          "  keys:\n"
                                          "    - {frame: 2, velocity_m_per_s: [6, 0, -60]}\n"
                                          "    - {frame: 6, velocity_m_per_s: [-2, 0, 20]}\n"
                                          "    - {frame: 7, velocity_m_per_s: [0, 0, 0]}\n");
    static const double areas[][2] = {
        {-4, -24}, {0, 0},      {1, 6},  {2, 12},      {3, 12 + 5}, {4, 12 + 8}, {5, 12 + 8},
        {7, 20},   {8, 20 + 1}, {9, 20}, {9.5, 19.25}, {10, 19},    {100, 19},
    };
    for (size_t i = 0; i < sizeof(areas) / sizeof(areas[0]); i++) {
        const double x_m = areas[i][1] / 2; /* two frames are a second */
        assert_vec3(neph_scene_wind_displacement_m(scene, areas[i][0]),
                    (struct neph_vec3){x_m, 0, -10 * x_m}, 1e-15, 0.0);
    }
    neph_scene_destroy(scene);
}

/* --- a static scene -------------------------------------------------------------------------- */

static const char all_media[] =
    "bake_resolution: 8\n"
    "media:\n"
    "  - gaussian: {center_m: [0, 1, 0], width_m: 0.5, " OPTICS ",\n"
    "      bounds: {min_m: [-0.4, 0, -1], max_m: [1, 2, 1]}}\n"
    "  - grid: {size: [2, 1, 3], origin_m: [0, 0, 0], spacing_m: [0.7, 1, 1.3],\n"
    "      values: [0, 1, 2, 0.5, 1, 0], " OPTICS "}\n"
    "  - gaussian: {center_m: [0, 1, 0], width_m: 0.5, voxels: 9, " OPTICS "}\n"
    "  - height_fog: {layers: [{extinction_per_m: 1, falloff_per_m: 1, height_m: 0}],\n"
    "      albedo: [1, 1, 1], bounds: {min_m: [-1, -1, -1], max_m: [1, 2, 1]}}\n"
    "  - homogeneous: {" OPTICS ", bounds: {min_m: [-1, 0, -1], max_m: [1, 2, 1]}}\n"
    "  - shell: {center_m: [0, -10, 0], radius_m: 9, scale_height_m: 1, " OPTICS ",\n"
    "      bounds: {min_m: [-1, 0, -1], max_m: [1, 2, 1]}}\n";
enum { DRIFTING = 3, MEDIA = 6 };

static const char windy[] =
    "frames: {count: 4, rate_hz: 4, pauses: [{frame: 1, count: 1}], sizes: [{frame: 2, scale: "
    "2}]}\n"
    "sun:\n"
    "  keys:\n"
    "    - {frame: 0, direction: [1, 1, 0], irradiance_w_per_m2: [1, 1, 1]}\n"
    "    - {frame: 4, direction: [0, 1, 1], irradiance_w_per_m2: [9, 1, 1]}\n"
    "wind:\n"
    "  keys:\n"
    "    - {frame: 0, velocity_m_per_s: [1, 0.5, 2]}\n"
    "    - {frame: 3, velocity_m_per_s: [2, 0.1, -7]}\n";

static const char level_wind[] = "frames: {rate_hz: 4}\nwind: {velocity_m_per_s: [2, 0, -3]}\n";
static const char clouds[] =
    "media:\n"
    "  - horizon: {seed: 7, planet_radius_m: 1e8, bottom_m: -60, coverage: 0.8,\n"
    "      texture_scale_m: 100, wind_m: [5, 0, 2], " OPTICS ",\n"
    "      bounds: {min_m: [-1000, -1000, -1000], max_m: [1000, 1000, 1000]}}\n";

static struct neph_vec3 random_place(uint64_t *seed)
{
    return (struct neph_vec3){neph_test_uniform(seed, -1, 1), neph_test_uniform(seed, 0, 2),
                              neph_test_uniform(seed, -1, 1)};
}

/* At some frames and positions, each of the first `drifting` media has at x its value of x -
 * displacement, and all others are unchanged. */
static void assert_drift(const struct neph_scene *scene, int drifting, double tolerance)
{
    uint64_t seed = 20270301;
    print_message("seed %llu\n", (unsigned long long)seed);
    double seen[NEPH_SCENE_MEDIA_MAX] = {0};
    for (int i = 0; i < 400; i++) {
        const double frame = neph_test_uniform(&seed, -3, 12);
        const struct neph_vec3 moved_m = neph_scene_wind_displacement_m(scene, frame);
        struct neph_diag diag = {.line = 0};
        struct neph_scene *still = NULL;
        neph_assert_ok(neph_scene_at(scene, frame, &still, &diag), &diag);
        for (int m = 0; m < scene->medium_count; m++) {
            const struct neph_vec3 there_m = random_place(&seed);
            const struct neph_vec3 here_m = m < drifting ? neph_vec3_add(there_m, moved_m)
                                                         : there_m;
            const double before = neph_medium_extinction_per_m(&scene->media[m], there_m);
            neph_assert_close(neph_medium_extinction_per_m(&still->media[m], here_m), before,
                              tolerance, tolerance);
            seen[m] += before;
        }
        neph_scene_destroy(still);
    }
    for (int m = 0; m < scene->medium_count; m++)
        if (!(seen[m] > 1.0))
            fail_msg("medium %d: there was nothing to compare", m);
}

/* Positions of some metres are rounded by 1e-15 m, and the media change by a few parts per metre.
 * No random position is on a face of the bounds. */
static void test_still_media_are_the_moved_ones(void **state)
{
    struct neph_scene *scene = load_three(cut_camera, windy, all_media);
    assert_int_equal(scene->medium_count, MEDIA);
    assert_drift(scene, DRIFTING, 1e-13);
    neph_scene_destroy(scene);
}

/* In a horizontal wind on an almost flat planet: over 10 m it falls by 10^2 / (2 * 1e8) = 5e-7 m,
 * and extinction changes by less than 0.2 per metre of height. */
static void test_still_clouds_are_the_moved_ones(void **state)
{
    struct neph_scene *scene = load_three(cut_camera, level_wind, clouds);
    assert_drift(scene, 1, 1e-7);
    neph_scene_destroy(scene);
}

/* --- solids ---------------------------------------------------------------------------------- */

/* A ball that orbits a pivot which moves along x, a box that rotates about its own centre, a fence
 * that slides, and a static box. */
static const char movers[] =
    "solids:\n"
    "  - sphere: {center_m: [3, 1, 0], radius_m: 0.5, albedo: [0, 0, 0], motion: {axis: y,\n"
    "      pivot_m: [1, 9, 0], keys: [{frame: 0}, {frame: 4, turn_deg: 90, move_m: [8, 0, 0]}]}}\n"
    "  - box: {min_m: [-1, 0, -3], max_m: [1, 2, -1], albedo: [0, 0, 0], motion: {axis: z,\n"
    "      pivot_m: [0, 1, -2], keys: [{frame: 2, turn_deg: -30}, {frame: 3, turn_deg: 30}]}}\n"
    "  - fence: {origin_m: [0, 0, 5], bars: 2, pitch_m: 1, bar_width_m: 0.1, bar_depth_m: 0.1,\n"
    "      height_m: 1, albedo: [0, 0, 0], motion: {keys: [{frame: 0, move_m: [0, 7, 0]}]}}\n"
    "  - box: {min_m: [5, 5, 5], max_m: [6, 6, 6], albedo: [0, 0, 0]}\n";

static void test_solids_are_where_their_keys_say(void **state)
{
    struct neph_scene *scene = load_three(camera, sun, movers);
    assert_int_equal(scene->mover_count, 3);
    /* Halfway: 45 degrees by the right hand about y take x towards -z; then 4 m along x. */
    const struct neph_vec3 ball_m = neph_scene_solid(scene, 0, 2).center_m;
    const double arm_m = 2.0 * sqrt(0.5);
    assert_vec3(ball_m, (struct neph_vec3){1 + arm_m + 4, 1, -arm_m}, 1e-15, 1e-15);
    assert_vec3(neph_scene_solid(scene, 0, 99).center_m, (struct neph_vec3){9, 1, -2}, 1e-15,
                1e-15);
    const struct neph_solid level = neph_scene_solid(scene, 1, 2.5);
    const struct neph_solid tilted = neph_scene_solid(scene, 1, 0);
    assert_true(level.turn.cosine == 0.0 && level.turn.sine == 0.0); /* as constructed */
    assert_vec3(tilted.box.min_m, (struct neph_vec3){-1, 0, -3}, 1e-15, 1e-15);
    assert_int_equal(tilted.turn.axis, 2);
    neph_assert_close(tilted.turn.sine, -0.5, 1e-15, 0.0);
    for (int bar = 2; bar < 4; bar++)
        assert_true(neph_scene_solid(scene, bar, 1).box.min_m.y == 7.0);
    assert_true(neph_scene_solid(scene, 4, 1).box.min_m.y == 5.0);
    neph_scene_destroy(scene);
}

/* A solid at a frame equals the solid of the static copy at this frame, hit by hit; and the moving
 * scene is unchanged. */
static void test_still_solids_are_the_moved_ones(void **state)
{
    struct neph_scene *scene = load_three(camera, sun, movers), *still = NULL;
    const struct neph_vec3 built_m = scene->solids[0].center_m;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_scene_at(scene, 1, &still, &diag), &diag);
    assert_true(neph_scene_moves(scene) && !neph_scene_moves(still));
    assert_int_equal(still->solid_count, scene->solid_count);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid own = neph_scene_solid(scene, i, 1);
        assert_memory_equal(&still->solids[i].box, &own.box, sizeof(own.box));
        assert_vec3(still->solids[i].center_m, own.center_m, 0.0, 0.0);
        assert_true(still->solids[i].turn.sine == own.turn.sine);
    }
    neph_scene_destroy(still);
    assert_vec3(scene->solids[0].center_m, built_m, 0.0, 0.0);
    assert_false(neph_scene_are_frames_equal(scene, 0, 1));
    assert_true(neph_scene_are_frames_equal(scene, 4, 5));
    neph_scene_destroy(scene);
}

/* A point of a moving solid moves with it, and the inverse gives the point. */
static void test_a_point_of_a_solid_is_found_before(void **state)
{
    struct neph_scene *scene = load_three(camera, sun, movers);
    const struct neph_placing here = neph_mover_placing(scene, &scene->movers[0], 3);
    const struct neph_placing there = neph_mover_placing(scene, &scene->movers[0], 1);
    const struct neph_vec3 now_m = neph_scene_solid(scene, 0, 3).center_m;
    const struct neph_vec3 then_m = neph_scene_solid(scene, 0, 1).center_m;
    assert_vec3(neph_find_earlier_place_m(&here, &there, now_m), then_m, 1e-14, 1e-14);
    assert_vec3(neph_find_earlier_place_m(&there, &here, then_m), now_m, 1e-14, 1e-14);
    neph_scene_destroy(scene);
}

/* --- a static scene -------------------------------------------------------------------------- */

static void test_still_scene_has_no_time_left(void **state)
{
    struct neph_scene *scene = load_three(cut_camera, windy, all_media);
    assert_true(neph_scene_moves(scene));
    const struct neph_vec3 center_m = scene->media[0].gaussian.center_m;
    struct neph_diag diag = {.line = 0};
    struct neph_scene *still = NULL, *again = NULL;
    neph_assert_ok(neph_scene_at(scene, 9.5, &still, &diag), &diag);
    assert_false(neph_scene_moves(still));
    assert_string_equal(still->hash, scene->hash);
    assert_true(still->media[1].grid->values == scene->media[1].grid->values); /* borrowed */

    const struct neph_sun now = neph_scene_sun(scene, 9.5);
    const struct neph_camera eye = neph_scene_camera(scene, 9.5);
    for (double frame = -1; frame < 20; frame += 3.5) { /* for any requested frame */
        const struct neph_sun sun_then = neph_scene_sun(still, frame);
        const struct neph_camera eye_then = neph_scene_camera(still, frame);
        assert_vec3(sun_then.direction, now.direction, 0.0, 0.0);
        assert_true(sun_then.irradiance_w_per_m2.r == now.irradiance_w_per_m2.r);
        assert_memory_equal(&eye_then, &eye, sizeof(eye));
        assert_vec3(neph_scene_wind_displacement_m(still, frame), (struct neph_vec3){0, 0, 0}, 0.0,
                    0.0);
        int width_px = 64, height_px = 36;
        neph_scene_frame_size(still, frame, &width_px, &height_px);
        assert_true(width_px == 64 && height_px == 36);
        assert_false(neph_scene_is_cut(still, 0, frame));
    }
    neph_assert_ok(neph_scene_at(still, 3, &again, &diag), &diag); /* and its static copy, too */
    assert_vec3(again->media[0].gaussian.center_m, still->media[0].gaussian.center_m, 0.0, 0.0);
    assert_vec3(again->media[1].grid->origin_m, still->media[1].grid->origin_m, 0.0, 0.0);
    neph_scene_destroy(again);
    neph_scene_destroy(still);
    assert_vec3(scene->media[0].gaussian.center_m, center_m, 0.0, 0.0); /* unchanged */
    assert_true(neph_medium_extinction_per_m(&scene->media[1], (struct neph_vec3){0, 0, 2}) > 0.0);
    neph_scene_destroy(scene);
}

/* --- lights ---------------------------------------------------------------------------------- */

/* A spot that moves, turns by a right angle and goes on in frame 8; a static point; a light with
 * one key. */
static const char keyed_lights[] =
    "frames: {count: 20, pauses: [{frame: 12, count: 5}]}\n"
    "lights:\n"
    "  - cone: {axis: [0, -3, 0], inner_deg: 10, outer_deg: 20}\n"
    "    keys:\n"
    "      - {frame: 0, position_m: [1, 2, 3], intensity_w_per_sr: [0, 0, 0]}\n"
    "      - {frame: 4, position_m: [1, 2, 7], intensity_w_per_sr: [0, 0, 0], axis: [2, 0, 0]}\n"
    "      - {frame: 8, position_m: [9, 2, 7], intensity_w_per_sr: [1, 2, 4], cut: true}\n"
    "      - {frame: 16, position_m: [9, 4, 7], intensity_w_per_sr: [3, 2, 0]}\n"
    "  - {position_m: [0, 9, 0], intensity_w_per_sr: [1, 1, 1]}\n"
    "  - keys: [{frame: 5, position_m: [0, 8, 0], intensity_w_per_sr: [2, 1, 1]}]\n";

static void test_lights_are_where_their_keys_say(void **state)
{
    static const struct {
        double frame;
        struct neph_vec3 position_m, axis;
        struct neph_rgb intensity;
    } cases[] = {
        {-1, {1, 2, 3}, {0, -1, 0}, {0, 0, 0}},     {0, {1, 2, 3}, {0, -1, 0}, {0, 0, 0}},
        {1, {1, 2, 4}, {0.5, 0, 0}, {0, 0, 0}},     {4, {1, 2, 7}, {1, 0, 0}, {0, 0, 0}},
        {7.5, {1, 2, 7}, {1, 0, 0}, {0, 0, 0}},     {8, {9, 2, 7}, {0, -1, 0}, {1, 2, 4}},
        {12, {9, 3, 7}, {0, -1, 0}, {2, 2, 2}},     {17, {9, 3, 7}, {0, -1, 0}, {2, 2, 2}},
        {19, {9, 3.5, 7}, {0, -1, 0}, {2.5, 2, 1}}, {99, {9, 4, 7}, {0, -1, 0}, {3, 2, 0}},
    };
    struct neph_scene *scene = load_three(camera, sun, keyed_lights);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const struct neph_light light = neph_scene_light(scene, 0, cases[i].frame);
        struct neph_vec3 axis = cases[i].axis;
        if (axis.x == 0.5) /* a quarter of the right angle */
            axis = (struct neph_vec3){sin(M_PI / 8.0), -cos(M_PI / 8.0), 0};
        assert_vec3(light.position_m, cases[i].position_m, 0.0, 0.0);
        assert_vec3(light.axis, axis, 1e-15, 0.0);
        assert_memory_equal(&light.intensity_w_per_sr, &cases[i].intensity,
                            sizeof(light.intensity_w_per_sr));
        assert_true(light.is_spot && light.key_count == 0 && !light.keys);
    }
    assert_vec3(scene->lights[0].axis, (struct neph_vec3){0, -1, 0}, 0.0, 0.0);
    assert_true(neph_scene_light(scene, 1, 9).position_m.y == 9.0);
    assert_int_equal(scene->lights[2].key_count, 0); /* one key: a static light */
    assert_true(scene->lights[2].position_m.y == 8.0);
    assert_true(scene->lights[2].intensity_w_per_sr.r == 2.0);
    neph_scene_destroy(scene);
}

/* The static scene of a frame has the lights of that frame, and no keys; the scene itself is
 * unchanged. */
static void test_still_lights_are_the_moved_ones(void **state)
{
    struct neph_scene *scene = load_three(camera, sun, keyed_lights), *still = NULL;
    struct neph_diag diag = {.line = 0};
    assert_true(neph_scene_moves(scene));
    for (int frame = 0; frame < scene->frame_count; frame++) {
        neph_assert_ok(neph_scene_at(scene, frame, &still, &diag), &diag);
        const struct neph_light light = neph_scene_light(scene, 0, frame);
        assert_false(neph_scene_moves(still));
        assert_vec3(still->lights[0].position_m, light.position_m, 0.0, 0.0);
        assert_vec3(still->lights[0].axis, light.axis, 0.0, 0.0);
        assert_true(still->lights[0].intensity_w_per_sr.b == light.intensity_w_per_sr.b);
        assert_true(still->lights[0].inner_cosine == scene->lights[0].inner_cosine);
        assert_true(neph_scene_light(still, 0, 3).position_m.z == light.position_m.z);
        neph_scene_destroy(still);
    }
    assert_true(scene->lights[0].key_count == 4 && scene->lights[0].position_m.z == 3.0);
    assert_false(neph_scene_is_static(scene));
    neph_scene_destroy(scene);
}

/* Each kind of key by itself gives another moment, and a pause gives none. */
static void test_different_moments_differ(void **state)
{
    static const struct {
        const char *camera, *sun, *rest;
        int frame_a, frame_b;
        bool same;
    } cases[] = {
        {camera, sun, "", 0, 7, true},
        {camera, sun, "frames: {count: 9, sizes: [{frame: 2, scale: 0.5}]}\n", 1, 2, false},
        {camera, sun, "frames: {count: 9, sizes: [{frame: 2, scale: 0.5}]}\n", 2, 8, true},
        {camera, sun,
         "wind: {velocity_m_per_s: [1, 0, 0]}\n"
         "frames: {count: 9, pauses: [{frame: 2, count: 3}]}\n"
         "media: [{gaussian: {center_m: [0, 1, 0], width_m: 1, extinction_per_m: 1,\n"
         "                    albedo: [1, 1, 1]}}]\n",
         2, 5, true},
        {camera, sun,
         "wind: {velocity_m_per_s: [1, 0, 0]}\n"
         "media: [{gaussian: {center_m: [0, 1, 0], width_m: 1, extinction_per_m: 1,\n"
         "                    albedo: [1, 1, 1]}}]\n",
         2, 3, false},
        {camera,
         "sun: {keys: [{frame: 2, direction: [0, 1, 0], irradiance_w_per_m2: [3, 3, 3]},\n"
         "             {frame: 3, direction: [0, 1, 0], irradiance_w_per_m2: [3, 3, 3.001]}]}\n",
         "", 2, 3, false},
        {camera,
         "sun: {keys: [{frame: 2, direction: [0, 1, 0], irradiance_w_per_m2: [3, 3, 3]},\n"
         "             {frame: 3, direction: [0, 1, 1], irradiance_w_per_m2: [3, 3, 3]}]}\n",
         "", 3, 9, true},
        {camera, sun, keyed_lights, 0, 1, false},
        {camera, sun, keyed_lights, 4, 7, true},
        {camera, sun, keyed_lights, 7, 8, false},
        {camera, sun, keyed_lights, 12, 17, true},
        {camera, sun, keyed_lights, 17, 18, false},
        {"camera: {keys: [{frame: 0, position_m: [0, 1, 50], look_at_m: [0, 1, 0]},\n"
         "                {frame: 5, position_m: [0, 1, 50], look_at_m: [0, 2, 0]}],\n"
         "         vertical_fov_deg: 40}\n",
         sun, "", 4, 5, false},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_scene *scene = load_three(cases[i].camera, cases[i].sun, cases[i].rest);
        assert_int_equal(neph_scene_are_frames_equal(scene, cases[i].frame_a, cases[i].frame_b),
                         cases[i].same);
        neph_scene_destroy(scene);
    }
}

#include "tests/main.h"

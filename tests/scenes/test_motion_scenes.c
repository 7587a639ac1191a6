/* SPDX-License-Identifier: MIT
 *
 * The scenes of scenes/studies/motion match their descriptions: what moves, how fast, and in which
 * frames the camera cuts. Rays of coarse frames show that solids and media are in view.
 */
#include "tests/neph_test.h"

#include "scenes/media.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

enum { FRAMES = 256, WIDTH = 32, HEIGHT = 18, STEPS = 48 };

static const double rate_hz = 30.0, degree = M_PI / 180.0;

/* The moving parts of a scene. */
enum { CAMERA = 1, WIND = 2, SUN = 4, SOLIDS = 8 };

static const struct {
    const char *name;
    int moving;
    int shot_frames; /* from cut to cut; 0: no cuts */
} scenes[] = {
    {"cumulus_flight", CAMERA, 0},
    {"lattice_mast", WIND, 0},
    {"forest_walk", CAMERA, 0},
    {"fence_dusk", SUN, 0},
    {"tower_orbit", CAMERA, 0},
    {"veil_cumulus", 0, 0},
    {"balcony_turn", CAMERA, 0},
    {"blast_shake", CAMERA | WIND, 0},
    {"street_cuts", CAMERA, 40},
    {"leaf_breeze", WIND | SOLIDS, 0},
    {"wire_storm", WIND, 0},
    {"mist_fence", WIND, 0},
    {"sun_race", SUN, 0},
    {"temple_noon", SUN, 0},
    {"coast_ride", CAMERA | WIND | SUN, 0},
    {"valley_chase", CAMERA | WIND | SUN, 0},
    {"rigging_swell", CAMERA | WIND, 0},
    {"porch_hand", CAMERA | WIND, 0},
    {"gorge_flight", CAMERA, 0},
    {"deck_skim", CAMERA, 0},
    {"bridge_walk", CAMERA, 0},
    {"pier_run", CAMERA, 0},
    {"square_turn", CAMERA, 0},
    {"lookout_pan", CAMERA, 0},
    {"ruin_orbit", CAMERA, 0},
    {"balloon_orbit", CAMERA, 0},
    {"truck_shake", CAMERA | WIND, 0},
    {"film_cuts", CAMERA, 32},
    {"reed_breeze", WIND | SOLIDS, 0},
    {"gale_lines", WIND, 0},
    {"scaffold_smoke", WIND, 0},
    {"obelisk_day", SUN, 0},
    {"blinds_evening", SUN, 0},
    {"raid_dawn", CAMERA | WIND | SUN, 0},
    {"barn_hand", CAMERA, 0},
};

enum { SCENES = sizeof(scenes) / sizeof(scenes[0]) };

static struct neph_scene *load(const char *name)
{
    char path[512];
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene = NULL;
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/studies/motion/%s.yaml", name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

/* ---- motion ---------------------------------------------------------------------------------- */

static bool is_equal(struct neph_vec3 a, struct neph_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool has_camera_moved(const struct neph_scene *scene, int frame)
{
    const struct neph_camera a = neph_scene_camera(scene, frame - 1);
    const struct neph_camera b = neph_scene_camera(scene, frame);
    return !is_equal(a.position_m, b.position_m) || !is_equal(a.forward, b.forward);
}

static bool has_wind_moved(const struct neph_scene *scene, int frame)
{
    return !is_equal(neph_scene_wind_displacement_m(scene, frame - 1),
                     neph_scene_wind_displacement_m(scene, frame));
}

static bool has_sun_moved(const struct neph_scene *scene, int frame)
{
    return !is_equal(neph_scene_sun(scene, frame - 1).direction,
                     neph_scene_sun(scene, frame).direction);
}

static bool has_solid_moved(const struct neph_scene *scene, int frame)
{
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid before = neph_scene_solid(scene, i, frame - 1);
        const struct neph_solid now = neph_scene_solid(scene, i, frame);
        if (!is_equal(neph_solid_bounds(&before).min_m, neph_solid_bounds(&now).min_m))
            return true;
    }
    return false;
}

/* Each part that moves does so in every frame, all others in none. */
static void test_parts_move_in_every_frame(void **state)
{
    static bool (*const checks[])(const struct neph_scene *, int) = {
        has_camera_moved, has_wind_moved, has_sun_moved, has_solid_moved};
    for (int i = 0; i < SCENES; i++) {
        struct neph_scene *scene = load(scenes[i].name);
        assert_int_equal(scene->frame_count, FRAMES);
        for (int part = 0; part < 4; part++)
            for (int frame = 1; frame < FRAMES; frame++)
                if (checks[part](scene, frame) != ((scenes[i].moving >> part & 1) != 0))
                    fail_msg("%s: part %d in frame %d", scenes[i].name, part, frame);
        assert_true(neph_scene_is_static(scene) == (scenes[i].moving == 0));
        neph_scene_destroy(scene);
    }
}

static void test_cameras_cut_where_told(void **state)
{
    for (int i = 0; i < SCENES; i++) {
        struct neph_scene *scene = load(scenes[i].name);
        for (int frame = 1; frame < FRAMES; frame++)
            assert_int_equal(neph_scene_is_cut(scene, frame - 1, frame),
                             scenes[i].shot_frames && frame % scenes[i].shot_frames == 0);
        neph_scene_destroy(scene);
    }
}

/* Ahead, over all frames: steps lift and sway the eye, but do not advance it. */
static void test_speeds_of_walks_and_flights(void **state)
{
    static const struct {
        const char *name;
        double m_per_s;
    } ways[] = {{"cumulus_flight", 60}, {"forest_walk", 1.4}, {"coast_ride", 6},
                {"gorge_flight", 25},   {"deck_skim", 90},    {"bridge_walk", 1.5},
                {"pier_run", 4}};
    for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
        struct neph_scene *scene = load(ways[i].name);
        const struct neph_vec3 way_m = neph_vec3_sub(neph_scene_camera(scene, FRAMES).position_m,
                                                     neph_scene_camera(scene, 0).position_m);
        neph_assert_close(hypot(way_m.x, way_m.z) / (FRAMES / rate_hz), ways[i].m_per_s, 0.0, 0.01);
        neph_scene_destroy(scene);
    }
}

/* Angle of the camera's axis around the vertical. */
static double yaw_rad(const struct neph_scene *scene, double frame)
{
    const struct neph_vec3 forward = neph_scene_camera(scene, frame).forward;
    return atan2(forward.x, -forward.z);
}

static void test_rates_of_turns_and_orbits(void **state)
{
    static const struct {
        const char *name;
        double deg_per_s, radius_m; /* of an orbit about x = z = 0, else 0 */
    } turns[] = {{"balcony_turn", 45, 0},
                 {"square_turn", 120, 0},
                 {"tower_orbit", -12, 46},
                 {"ruin_orbit", -20, 13},
                 {"balloon_orbit", -6, 34}};
    for (size_t i = 0; i < sizeof(turns) / sizeof(turns[0]); i++) {
        struct neph_scene *scene = load(turns[i].name);
        for (int frame = 2; frame <= FRAMES; frame += 2) {
            const double turned = yaw_rad(scene, frame) - yaw_rad(scene, frame - 2);
            const struct neph_vec3 place_m = neph_scene_camera(scene, frame).position_m;
            neph_assert_close(remainder(turned, 2.0 * M_PI),
                              turns[i].deg_per_s * degree * 2.0 / rate_hz, 0.0, 2e-5);
            neph_assert_close(hypot(place_m.x, place_m.z), turns[i].radius_m, 0.0, 1e-3);
        }
        neph_scene_destroy(scene);
    }
}

/* By less than a pixel of 384x216, in every frame, with many returns: the tremor has 7 Hz. */
static void test_hands_shake_by_parts_of_a_pixel(void **state)
{
    static const char *const names[] = {"porch_hand", "barn_hand"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_scene *scene = load(names[i]);
        const double pixel_rad = 2.0 * tan(0.5 * scene->vertical_fov_rad) / 216.0;
        double before_rad = 0.0;
        int returns = 0;
        for (int frame = 1; frame < FRAMES; frame++) {
            const double turned_rad = yaw_rad(scene, frame) - yaw_rad(scene, frame - 1);
            const double moved_px =
                acos(fmin(1.0, neph_vec3_dot(neph_scene_camera(scene, frame).forward,
                                             neph_scene_camera(scene, frame - 1).forward))) /
                pixel_rad;
            assert_true(moved_px > 0.01 && moved_px < 1.0);
            returns += turned_rad * before_rad < 0.0;
            before_rad = turned_rad;
        }
        assert_true(returns > 60);
        neph_scene_destroy(scene);
    }
}

/* Degrees per frame along the path of the sun. */
static void test_rates_of_the_sun(void **state)
{
    static const struct {
        const char *name;
        double azimuth_deg, elevation_deg;
    } suns[] = {{"fence_dusk", 0.0078, -0.02},  {"sun_race", 0.55, 0.078},
                {"temple_noon", 0.03, 0.0},     {"coast_ride", 0.0078, -0.02},
                {"valley_chase", 0.3, 0.039},   {"obelisk_day", 0.8, 0.0},
                {"blinds_evening", 0.0, -0.02}, {"raid_dawn", 0.0156, 0.03}};
    for (size_t i = 0; i < sizeof(suns) / sizeof(suns[0]); i++) {
        struct neph_scene *scene = load(suns[i].name);
        for (int frame = 8; frame <= FRAMES; frame += 8) {
            const struct neph_vec3 a = neph_scene_sun(scene, frame - 8).direction;
            const struct neph_vec3 b = neph_scene_sun(scene, frame).direction;
            const double turned = remainder(atan2(b.x, -b.z) - atan2(a.x, -a.z), 2.0 * M_PI);
            neph_assert_close(turned / degree / 8.0, suns[i].azimuth_deg, 0.0, 0.004);
            neph_assert_close((asin(b.y) - asin(a.y)) / degree / 8.0, suns[i].elevation_deg, 0.0,
                              0.002);
        }
        neph_scene_destroy(scene);
    }
}

static void test_speeds_of_the_wind(void **state)
{
    static const struct {
        const char *name;
        double m_per_s;
    } winds[] = {{"lattice_mast", 14}, {"leaf_breeze", 2},    {"wire_storm", 28},
                 {"porch_hand", 3},    {"mist_fence", 0.5},   {"coast_ride", 10},
                 {"valley_chase", 20}, {"rigging_swell", 8},  {"reed_breeze", 0.8},
                 {"gale_lines", 40},   {"scaffold_smoke", 5}, {"raid_dawn", 16}};
    for (size_t i = 0; i < sizeof(winds) / sizeof(winds[0]); i++) {
        struct neph_scene *scene = load(winds[i].name);
        const double way_m = neph_vec3_length(neph_scene_wind_displacement_m(scene, 30.0));
        neph_assert_close(way_m, winds[i].m_per_s, 0.0, 0.021 * winds[i].m_per_s);
        neph_scene_destroy(scene);
    }
}

/* ---- content --------------------------------------------------------------------------------- */

/* Optical depth of the media of a static scene along a ray, by midpoints. */
static double optical_depth(const struct neph_scene *scene, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double end_m)
{
    double sum = 0.0, before_m = 0.0;
    for (int i = 1; i <= STEPS; i++) {
        const double here_m = end_m * i * i / (STEPS * STEPS), middle_m = 0.5 * (before_m + here_m);
        const struct neph_vec3 point_m = neph_vec3_add(origin_m,
                                                       neph_vec3_scale(direction, middle_m));
        for (int m = 0; m < scene->medium_count; m++)
            sum += (here_m - before_m) * neph_medium_extinction_per_m(&scene->media[m], point_m);
        before_m = here_m;
    }
    return sum;
}

/* Shares of rays that hit a solid, and of those that cross a medium which can be seen. */
static void measure_shares(const struct neph_scene *scene, double *solids, double *media)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    int hits = 0, crossed = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const struct neph_vec3 ray = neph_camera_ray(&camera, WIDTH, HEIGHT, x, y).direction;
            const double end_m = neph_scene_hit(scene, camera.position_m, ray).t_m;
            hits += isfinite(end_m);
            crossed += optical_depth(scene, camera.position_m, ray, fmin(end_m, 6000.0)) > 0.05;
        }
    *solids = (double)hits / (WIDTH * HEIGHT);
    *media = (double)crossed / (WIDTH * HEIGHT);
}

/* In the first frame, in the middle and at the end. Also: few solids, so that a march is quick. */
static void test_solids_and_media_are_in_view(void **state)
{
    for (int i = 0; i < SCENES; i++) {
        struct neph_scene *scene = load(scenes[i].name);
        assert_true(scene->solid_count <= 36);
        for (int frame = 0; frame < FRAMES; frame += 120) {
            struct neph_scene *now = NULL;
            double solids, media;
            neph_assert_ok(neph_scene_at(scene, frame, &now, NULL), NULL);
            measure_shares(now, &solids, &media);
            if (solids < 0.02 || solids > 0.98 || media < 0.08)
                fail_msg("%s, frame %d: %g solids, %g media", scenes[i].name, frame, solids, media);
            neph_scene_destroy(now);
        }
        neph_scene_destroy(scene);
    }
}

/* The thinnest solid in a frame, across the line of sight, in pixels of a frame of this height. */
static double find_thinnest_px(const struct neph_scene *scene, int height_px)
{
    const struct neph_camera camera = neph_scene_camera(scene, 0);
    const double slope = 2.0 * tan(0.5 * camera.vertical_fov_rad) / height_px;
    double thinnest_px = INFINITY;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&scene->solids[i]);
        const struct neph_vec3 size_m = neph_vec3_sub(box.max_m, box.min_m);
        const struct neph_vec3 middle_m = neph_vec3_scale(neph_vec3_add(box.min_m, box.max_m), 0.5);
        const double depth_m = neph_vec3_dot(neph_vec3_sub(middle_m, camera.position_m),
                                             camera.forward);
        if (depth_m > 0.0)
            thinnest_px = fmin(thinnest_px, fmin(size_m.x, size_m.y) / (slope * depth_m));
    }
    return thinnest_px;
}

/* The descriptions are of 384x216, to a third of a pixel; at 192x108 a solid has half as many
 * pixels, at 960x540 2.5 times as many. */
static void test_thin_solids_have_their_pixels(void **state)
{
    static const struct {
        const char *name;
        double px;
    } thin[] = {{"lattice_mast", 1.0},   {"leaf_breeze", 3.0},  {"wire_storm", 1.0},
                {"mist_fence", 2.0},     {"reed_breeze", 1.0},  {"balloon_orbit", 1.0},
                {"scaffold_smoke", 1.0}, {"rigging_swell", 0.6}};
    for (size_t i = 0; i < sizeof(thin) / sizeof(thin[0]); i++) {
        struct neph_scene *scene = load(thin[i].name);
        const double px = find_thinnest_px(scene, 216);
        neph_assert_close(px, thin[i].px, 0.0, 1.0 / 3.0);
        neph_assert_close(find_thinnest_px(scene, 108), px / 2.0, 1e-12, 0.0);
        neph_assert_close(find_thinnest_px(scene, 540), px * 2.5, 1e-12, 0.0);
        neph_scene_destroy(scene);
    }
}

static void test_no_two_scenes_are_equal(void **state)
{
    char hashes[SCENES][NEPH_HASH_HEX_SIZE];
    for (int i = 0; i < SCENES; i++) {
        struct neph_scene *scene = load(scenes[i].name);
        memcpy(hashes[i], scene->hash, sizeof(hashes[i]));
        for (int j = 0; j < i; j++)
            assert_string_not_equal(hashes[i], hashes[j]);
        neph_scene_destroy(scene);
    }
}

#include "tests/main.h"

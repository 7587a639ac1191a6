/* SPDX-License-Identifier: MIT
 *
 * Scenes at another frame rate: everything is at the same place at the same time.
 */
#include "tests/neph_test.h"

#include "scenes/frame_rate.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

static struct neph_scene *load(const char *folder, const char *name)
{
    char path[512];
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene = NULL;
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/%s/%s.yaml", folder, name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static struct neph_scene *load_at(const char *name, double rate_hz)
{
    struct neph_scene *scene = load("studies/motion", name);
    assert_null(neph_frame_rate_obstacle(scene, rate_hz));
    neph_assert_ok(neph_scene_set_frame_rate(scene, rate_hz, NULL), NULL);
    return scene;
}

/* 60 m/s along -z from z = 600: a metre per frame at 60 Hz, two at 30 Hz, a half at 120 Hz. */
static void test_a_flight_has_its_speed_at_every_rate(void **state)
{
    static const double rates_hz[] = {24, 30, 60, 120};
    for (size_t i = 0; i < sizeof(rates_hz) / sizeof(rates_hz[0]); i++) {
        struct neph_scene *scene = load_at("cumulus_flight", rates_hz[i]);
        assert_true(scene->frame_rate_hz == rates_hz[i]);
        assert_int_equal(scene->frame_count, lround(256 * rates_hz[i] / 30.0));
        for (int frame = 0; frame < scene->frame_count; frame++)
            neph_assert_close(neph_scene_camera(scene, frame).position_m.z,
                              600.0 - 60.0 * frame / rates_hz[i], 1e-12, 0.0);
        neph_scene_destroy(scene);
    }
}

/* 28 m/s: the displacement is the velocity times the time. */
static void test_a_wind_has_its_speed_at_every_rate(void **state)
{
    static const double rates_hz[] = {24, 30, 60, 120};
    for (size_t i = 0; i < sizeof(rates_hz) / sizeof(rates_hz[0]); i++) {
        struct neph_scene *scene = load_at("wire_storm", rates_hz[i]);
        for (int frame = 0; frame < scene->frame_count; frame++)
            neph_assert_close(neph_scene_wind_displacement_m(scene, frame).x,
                              28.0 * frame / rates_hz[i], 1e-12, 1e-12);
        neph_scene_destroy(scene);
    }
}

/* ---- the same place at the same time --------------------------------------------------------- */

static void assert_same(struct neph_vec3 a, struct neph_vec3 b)
{
    assert_true(a.x == b.x && a.y == b.y && a.z == b.z);
}

/* Bit by bit: at twice and half of the rate every key is moved exactly. */
static void assert_same_moment(const struct neph_scene *a, double frame_a,
                               const struct neph_scene *b, double frame_b)
{
    const struct neph_camera camera_a = neph_scene_camera(a, frame_a);
    const struct neph_camera camera_b = neph_scene_camera(b, frame_b);
    const struct neph_sun sun_a = neph_scene_sun(a, frame_a), sun_b = neph_scene_sun(b, frame_b);
    assert_same(camera_a.position_m, camera_b.position_m);
    assert_same(camera_a.forward, camera_b.forward);
    assert_same(sun_a.direction, sun_b.direction);
    assert_true(sun_a.irradiance_w_per_m2.r == sun_b.irradiance_w_per_m2.r);
    assert_same(neph_scene_wind_displacement_m(a, frame_a),
                neph_scene_wind_displacement_m(b, frame_b));
    for (int i = 0; i < a->light_count; i++)
        assert_same(neph_scene_light(a, i, frame_a).position_m,
                    neph_scene_light(b, i, frame_b).position_m);
    for (int i = 0; i < a->solid_count; i++) {
        const struct neph_solid solid_a = neph_scene_solid(a, i, frame_a);
        const struct neph_solid solid_b = neph_scene_solid(b, i, frame_b);
        assert_same(neph_solid_bounds(&solid_a).min_m, neph_solid_bounds(&solid_b).min_m);
    }
}

/* Camera with cuts, with a shake; camera, wind and sun; wind and solids. Cuts are at the same
 * time. */
static void test_all_that_moves_is_at_its_place_at_60_hz(void **state)
{
    static const char *const names[] = {"street_cuts", "blast_shake", "valley_chase",
                                        "leaf_breeze"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_scene *own = load("studies/motion", names[i]);
        struct neph_scene *fast = load_at(names[i], 60.0), *slow = load_at(names[i], 15.0);
        assert_int_equal(fast->frame_count, 2 * own->frame_count);
        assert_int_equal(2 * slow->frame_count, own->frame_count);
        for (int frame = 0; frame < own->frame_count; frame++) {
            assert_same_moment(own, frame, fast, 2 * frame);
            assert_same_moment(own, frame + 0.5, fast, 2 * frame + 1);
            assert_same_moment(own, frame, slow, 0.5 * frame);
            assert_true(neph_scene_is_cut(own, frame, frame + 1) ==
                        neph_scene_is_cut(fast, 2 * frame, 2 * frame + 2));
        }
        neph_scene_destroy(own);
        neph_scene_destroy(fast);
        neph_scene_destroy(slow);
    }
}

/* A lamp and a camera at 3 m/s. */
static void test_lights_have_their_speed_at_60_hz(void **state)
{
    struct neph_scene *own = load("stress", "lamp_walk"), *fast = load("stress", "lamp_walk");
    neph_assert_ok(neph_scene_set_frame_rate(fast, 60.0, NULL), NULL);
    assert_string_not_equal(own->hash, fast->hash);
    for (int frame = 0; frame < own->frame_count; frame++) {
        assert_same_moment(own, frame, fast, 2 * frame);
        neph_assert_close(neph_scene_light(fast, 0, frame).position_m.z, -2.0 - 3.0 * frame / 60.0,
                          1e-12, 0.0);
    }
    neph_scene_destroy(own);
    neph_scene_destroy(fast);
}

/* The hash is the hash of the motion: the way back restores it, a rate of 0 is the scene's own. */
static void test_the_hash_is_of_the_rate(void **state)
{
    struct neph_scene *own = load("studies/motion", "leaf_breeze");
    struct neph_scene *made = load_at("leaf_breeze", 0.0);
    assert_string_equal(made->hash, own->hash);
    neph_assert_ok(neph_scene_set_frame_rate(made, 60.0, NULL), NULL);
    assert_string_not_equal(made->hash, own->hash);
    neph_assert_ok(neph_scene_set_frame_rate(made, 30.0, NULL), NULL);
    assert_string_equal(made->hash, own->hash);
    neph_scene_destroy(made);
    neph_scene_destroy(own);
}

static void test_scenes_that_count_frames_keep_their_rate(void **state)
{
    static const char *const names[] = {"pause_wind", "uneven_time", "clouds_away"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_scene *scene = load("stress", names[i]);
        assert_non_null(neph_frame_rate_obstacle(scene, 2.0 * scene->frame_rate_hz));
        assert_null(neph_frame_rate_obstacle(scene, scene->frame_rate_hz));
        assert_null(neph_frame_rate_obstacle(scene, 0.0));
        neph_scene_destroy(scene);
    }
}

#include "tests/main.h"

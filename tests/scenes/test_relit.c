/* SPDX-License-Identifier: MIT
 *
 * Scenes with a different sun: its position, other changes, and refused requests.
 */
#include "tests/neph_test.h"

#include "scenes/motion.h"
#include "scenes/relit.h"

static const struct neph_relight as_it_was = {NAN, NAN, NAN, NAN, NAN, 0.0};

static struct neph_scene *load(const char *name)
{
    char path[512];
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    snprintf(path, sizeof(path), "%s/scenes/catalog/%s.yaml", NEPH_SOURCE_DIR, name);
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static struct neph_scene *relight(const struct neph_scene *scene, const struct neph_relight *light)
{
    struct neph_scene *made = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_scene_relit(scene, light, NEPH_SCATTERING_MULTIPLE, &made, &diag), &diag);
    return made;
}

/* The camera looks along -z, from (0, 2, 6) down to (0, 1, 0). */
static void test_where_the_sun_is(void **state)
{
    static const struct {
        double elevation_deg, azimuth_deg;
        struct neph_vec3 direction;
    } cases[] = {{0, 0, {0, 0, -1}},
                 {0, 180, {0, 0, 1}},
                 {0, 90, {1, 0, 0}},
                 {30, 90, {0.86602540378443865, 0.5, 0}},
                 {90, 17, {0, 1, 0}}};
    struct neph_scene *scene = load("gaussian_blob");
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_relight light = as_it_was;
        light.sun_elevation_rad = cases[i].elevation_deg * NEPH_RAD_PER_DEG;
        light.sun_azimuth_rad = cases[i].azimuth_deg * NEPH_RAD_PER_DEG;
        struct neph_scene *made = relight(scene, &light);
        const struct neph_vec3 sun = made->sun.direction, expected = cases[i].direction;
        assert_true(neph_vec3_length(neph_vec3_sub(sun, expected)) < 1e-12);
        const struct neph_relight found = neph_relight_of(made);
        neph_assert_close(found.sun_elevation_rad, light.sun_elevation_rad, 0.0, 1e-7);
        if (cases[i].elevation_deg < 90)
            neph_assert_close(cos(found.sun_azimuth_rad), cos(light.sun_azimuth_rad), 0.0, 1e-7);
        neph_scene_destroy(made);
    }
    neph_scene_destroy(scene);
}

/* A sinking sun ends at the given position, and moves evenly, in one plane. */
static void test_a_sun_that_sinks(void **state)
{
    enum { LAST = NEPH_RELIT_FRAMES - 1 };
    struct neph_scene *scene = load("gaussian_blob");
    struct neph_relight light = as_it_was;
    light.sun_elevation_rad = 0.6;
    light.sun_azimuth_rad = 2.0;
    struct neph_scene *still = relight(scene, &light);
    light.sun_sinks_rad = 0.3;
    struct neph_scene *made = relight(scene, &light);
    const struct neph_vec3 end = neph_scene_sun(made, LAST).direction;
    assert_true(neph_vec3_length(neph_vec3_sub(end, still->sun.direction)) < 1e-12);
    assert_true(neph_scene_moves(made) && !neph_scene_moves(still));
    for (int frame = 0; frame <= LAST; frame++) {
        const struct neph_vec3 sun = neph_scene_sun(made, frame).direction;
        neph_assert_close(asin(sun.y), 0.9 - 0.3 * frame / LAST, 1e-12, 0.0);
        neph_assert_close(atan2(sun.x, sun.z), atan2(end.x, end.z), 1e-12, 0.0);
    }
    neph_scene_destroy(made);
    neph_scene_destroy(still);
    neph_scene_destroy(scene);
}

static void test_what_stays_and_what_changes(void **state)
{
    struct neph_scene *scene = load("height_fog_multiple");
    struct neph_scene *same = relight(scene, &as_it_was);
    assert_memory_equal(&same->sun.direction, &scene->sun.direction, sizeof(struct neph_vec3));
    assert_true(same->sun.irradiance_w_per_m2.r == 1.0 && same->sun.irradiance_w_per_m2.b == 1.0);
    assert_true(same->background_w_per_m2_sr.g == 0.0 && !same->environment_light);
    assert_true(same->solid_count == 1 && same->solids[0].albedo.g == 0.0);
    assert_true(same->media[0].phase.g == 0.6 && same->media[0].extinction_color.g == 1.0);
    const struct neph_relight light = {NAN, NAN, 0.2, 0.9, 3.0, 0.0};
    struct neph_scene *other = relight(scene, &light);
    assert_string_not_equal(other->hash, same->hash);
    assert_true(other->media[0].phase.g == 0.2 && other->media[0].albedo.b == 0.9);
    assert_true(other->media[0].extinction_color.r == 3.0);
    assert_true(other->media[0].layers[0].extinction_per_m == 0.4);
    neph_scene_destroy(other);
    neph_scene_destroy(same);
    neph_scene_destroy(scene);
}

static void test_nothing_moves(void **state)
{
    struct neph_scene *scene = load("camera_dolly");
    assert_true(scene->frame_count > 1);
    struct neph_scene *made = relight(scene, &as_it_was);
    assert_int_equal(made->frame_count, 1);
    assert_int_equal(made->camera_key_count, 1);
    neph_scene_destroy(made);
    neph_scene_destroy(scene);
}

static void refuse(const char *name, const struct neph_relight *light, enum neph_status expected)
{
    struct neph_scene *scene = load(name), *made = NULL;
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_scene_relit(scene, light, NEPH_SCATTERING_MULTIPLE, &made, &diag),
                     expected);
    assert_null(made);
    assert_true(diag.message[0] != '\0');
    neph_scene_destroy(scene);
}

static void test_refusals(void **state)
{
    refuse("glowing_slab", &as_it_was, NEPH_ERR_UNSUPPORTED);
    refuse("coloured_fog", &as_it_was, NEPH_ERR_UNSUPPORTED);
    refuse("white_furnace", &as_it_was, NEPH_ERR_UNSUPPORTED); /* no sun */
    refuse("gaussian_blob", &(struct neph_relight){NAN, NAN, NAN, NAN, NAN, -0.1}, NEPH_ERR_USAGE);
    refuse("gaussian_blob", &(struct neph_relight){2.0, NAN, NAN, NAN, NAN, 0.0}, NEPH_ERR_USAGE);
    refuse("gaussian_blob", &(struct neph_relight){NAN, NAN, 1.0, NAN, NAN, 0.0}, NEPH_ERR_USAGE);
    refuse("gaussian_blob", &(struct neph_relight){NAN, NAN, NAN, 1.1, NAN, 0.0}, NEPH_ERR_USAGE);
    refuse("gaussian_blob", &(struct neph_relight){NAN, NAN, NAN, NAN, -1.0, 0.0}, NEPH_ERR_USAGE);
    refuse("gaussian_blob", &(struct neph_relight){NAN, NAN, INFINITY, NAN, NAN, 0.0},
           NEPH_ERR_USAGE);
}

#include "tests/main.h"

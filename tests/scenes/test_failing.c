/* SPDX-License-Identifier: MIT
 *
 * The failures that a scene file declares: read with defaults, refused with line and reason; a
 * sweep is the file with other values.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "scenes/failing.h"
#include "scenes/scene.h"

#include <math.h>

#define HEAD                                                                                       \
    "name: probe\n"                                                                                \
    "title: a probe\n"                                                                             \
    "physics: none\n"                                                                              \
    "camera: {position_m: [0, 1, 5], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"                \
    "scattering: none\n"                                                                           \
    "media:\n"                                                                                     \
    "  - gaussian: {center_m: [0, 1, 0], width_m: 1, extinction_per_m: 1, albedo: [1, 1, 1]}\n"
#define BLOCK                                                                                      \
    "failure:\n"                                                                                   \
    "  fails: a thing\n"                                                                           \
    "  known: somebody\n"                                                                          \
    "  symptom: blinks\n"                                                                          \
    "  frames: 40\n"                                                                               \
    "  measures:\n"                                                                                \
    "    - {measure: error, limit: 0.5, reason: half}\n"                                           \
    "    - {measure: flicker, over: depth_edge, limit: 1, reason: the eye}\n"
#define SWEEP                                                                                      \
    "  sweep:\n"                                                                                   \
    "    - {name: width_m, set: \"media[0].gaussian.width_m\", to: [2, 0.25]}\n"                   \
    "    - {name: x_m, set: \"camera.position_m[0] camera.look_at_m[0]\", by: [10, 20, 30]}\n"

static enum neph_status load(void **state, const char *text, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    return neph_scene_load(path, scene, diag);
}

static struct neph_scene *loaded(void **state, const char *text)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(load(state, text, &scene, &diag), &diag);
    return scene;
}

static void test_a_scene_may_say_nothing(void **state)
{
    struct neph_scene *scene = loaded(state, HEAD);
    assert_null(scene->failing->fails);
    assert_int_equal(neph_failing_point_count(scene->failing), 1);
    neph_scene_destroy(scene);
}

static void test_defaults_and_what_is_given(void **state)
{
    struct neph_scene *scene = loaded(state, HEAD BLOCK);
    const struct neph_failing *failing = scene->failing;
    assert_string_equal(failing->fails, "a thing");
    assert_string_equal(failing->presets, "");
    assert_int_equal(failing->width_px, 96);
    assert_int_equal(failing->height_px, 54);
    assert_int_equal(failing->frame_count, 40);
    assert_int_equal(failing->steps, 8);
    assert_int_equal(failing->truth, NEPH_FAILING_MARCH);
    assert_false(failing->quick);
    assert_int_equal(failing->limit_count, 2);
    assert_string_equal(failing->limits[0].over, "all");
    assert_string_equal(failing->limits[1].over, "depth_edge");
    assert_int_equal(failing->limits[1].measure, NEPH_FAILING_FLICKER);
    assert_int_equal(failing->limits[1].line, 15);
    neph_scene_destroy(scene);
}

/* Limits may change without re-rendering. */
static void test_the_hash_knows_nothing_of_it(void **state)
{
    struct neph_scene *with = loaded(state, HEAD BLOCK SWEEP), *without = loaded(state, HEAD);
    assert_string_equal(with->hash, without->hash);
    neph_scene_destroy(with);
    neph_scene_destroy(without);
}

static void test_points_are_the_product_of_the_axes(void **state)
{
    struct neph_scene *scene = loaded(state, HEAD BLOCK SWEEP), *at = NULL;
    static const struct {
        const char *name;
        double width_m, x_m;
    } points[] = {{"", 1, 0},
                  {"width_m=2 x_m+=10", 2, 10},
                  {"width_m=2 x_m+=20", 2, 20},
                  {"width_m=2 x_m+=30", 2, 30},
                  {"width_m=0.25 x_m+=10", 0.25, 10},
                  {"width_m=0.25 x_m+=20", 0.25, 20},
                  {"width_m=0.25 x_m+=30", 0.25, 30}};
    struct neph_diag diag = {.line = 0};
    assert_int_equal(neph_failing_point_count(scene->failing), 7);
    for (int p = 0; p < 7; p++) {
        char name[NEPH_FAILING_POINT_SIZE];
        neph_failing_point_name(scene->failing, p, name, sizeof(name));
        assert_string_equal(name, points[p].name);
        neph_assert_ok(neph_scene_load_point(scene, p, &at, &diag), &diag);
        assert_true(at->media[0].gaussian.width_m == points[p].width_m);
        assert_true(at->camera_keys[0].position_m.x == points[p].x_m);
        assert_true(at->camera_keys[0].look_at_m.x == points[p].x_m);
        assert_true((strcmp(at->hash, scene->hash) == 0) == (p == 0));
        neph_scene_destroy(at);
    }
    neph_scene_destroy(scene);
}

/* The block's own keys may be swept as well. */
static void test_steps_and_sizes_can_be_swept(void **state)
{
    struct neph_scene *at = NULL;
    struct neph_scene *scene = loaded(state,
                                      HEAD BLOCK "  sweep:\n"
                                                 "    - {name: n, set: failure.frames, to: [8]}\n");
    neph_assert_ok(neph_scene_load_point(scene, 1, &at, NULL), NULL);
    assert_int_equal(at->failing->frame_count, 8);
    neph_scene_destroy(at);
    neph_scene_destroy(scene);
}

/* A point with an invalid value is refused like a file. */
static void test_a_point_out_of_range_is_refused(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *at = NULL;
    struct neph_scene *scene = loaded(
        state, HEAD BLOCK "  sweep:\n"
                          "    - {name: w, set: \"media[0].gaussian.width_m\", to: [-1]}\n");
    assert_int_equal(neph_scene_load_point(scene, 1, &at, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "width_m"));
    assert_null(at);
    neph_scene_destroy(scene);
}

static void test_what_is_wrong_is_named(void **state)
{
    static const struct {
        const char *text;
        int line;
        const char *words;
    } bad[] = {
        {"failure: {fails: a, known: b, measures: []}\n", 8, "measures"},
        {"failure: {fails: a, known: b, symptom: c, measures: [{measure: eror, limit: 1, "
         "reason: d}]}\n",
         8, "error"},
        {"failure: {fails: a, known: b, symptom: c, measures: [{measure: error, limit: 1}]}\n", 8,
         "reason"},
        {"failure: {fails: a, known: b, symptom: c, measures: [{measure: error, limit: -1, "
         "reason: d}]}\n",
         8, "-1"},
        {"failure: {fails: a, known: b, symptom: c, measures: [{measure: error, over: wire, "
         "limit: 1, reason: d}]}\n",
         8, "thin"},
        {"failure: {fails: a, known: b, symptom: c, measures: [{measure: lag, limit: 1, "
         "reason: d}]}\n",
         8, "event_frame"},
        {BLOCK "  event_frame: 40\n", 16, "40 is not one of the 40 frames"},
        {BLOCK "  sweep:\n    - {name: a, set: \"media[0].gaussian.width_m\"}\n", 17,
         "either to or by"},
        {BLOCK "  sweep:\n    - {name: a, set: \"media[0].gaussian.width_m\", to: [1], by: [1]}\n",
         17, "either to or by"},
        {BLOCK "  sweep:\n    - {name: a, set: \"media[1].gaussian.width_m\", to: [1]}\n", 17,
         "no number at 'media[1].gaussian.width_m'"},
        {BLOCK "  sweep:\n    - {name: a, set: camera.vertical_fov_deg.x, to: [1]}\n", 17,
         "no number at"},
        {BLOCK "  sweep:\n    - {name: a, set: title, to: [1]}\n", 17, "no number at 'title'"},
        {BLOCK "  sweep:\n    - {name: A b, set: \"media[0].gaussian.width_m\", to: [1]}\n", 17,
         "name"},
    };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {.line = 0};
        char *text = neph_format("%s%s", HEAD, bad[i].text);
        assert_int_equal(load(state, text, &scene, &diag), NEPH_ERR_INPUT);
        assert_null(scene);
        if (!strstr(diag.message, bad[i].words) && !strstr(diag.hint, bad[i].words) &&
            !strstr(diag.more, bad[i].words))
            fail_msg("%s: %s (%s)\n%s", bad[i].text, diag.message, diag.hint, diag.more);
        assert_int_equal(diag.line, bad[i].line);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_scene_may_say_nothing),
        scratch_test(test_defaults_and_what_is_given),
        scratch_test(test_the_hash_knows_nothing_of_it),
        scratch_test(test_points_are_the_product_of_the_axes),
        scratch_test(test_steps_and_sizes_can_be_swept),
        scratch_test(test_a_point_out_of_range_is_refused),
        scratch_test(test_what_is_wrong_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: MIT
 *
 * The pictures of the physics suite: drawn for every view and row that has a frame, named in the
 * document, of the truth's size, and the truth's numbers leave the document.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "harness/physics/pictures.h"

enum { WIDTH = 6, HEIGHT = 4, PIXELS = WIDTH * HEIGHT };

static const struct neph_check_view view = {
    .stage = {.name = "probe",
              .truth = NEPH_STAGE_TRUTH_SLAB,
              .sun_cosine = 0.5,
              .view_azimuth_rad = 1.0471975511965976,
              .view_elevation_rad = -0.8726646259971648,
              .vertical_fov_rad = 0.7,
              .aspect = 1.5},
    .factor = 1.0,
    .width_px = WIDTH,
    .height_px = HEIGHT,
};

static void fill_truth(double truth[PIXELS])
{
    for (int p = 0; p < PIXELS; p++)
        truth[p] = 0.1 + 0.01 * p;
}

/* A frame of truth times `factor`. */
static void write_frame(const char *path, int width_px, double factor)
{
    struct neph_diag diag = {.line = 0};
    struct neph_image *image;
    float *planes[3];
    double truth[PIXELS];
    fill_truth(truth);
    neph_assert_ok(neph_image_create(width_px, HEIGHT, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    for (int p = 0; p < width_px * HEIGHT; p++)
        planes[0][p] = planes[1][p] = planes[2][p] = (float)(truth[p] * factor);
    neph_assert_ok(neph_exr_write(path, image, &diag), &diag);
    neph_image_destroy(image);
}

/* A document of one check, and one row per frame; a NULL frame was not rendered. */
static json_t *document(const char *const *names, const char *const *frames, int count)
{
    double truth[PIXELS];
    fill_truth(truth);
    json_t *rows = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&rows, json_pack("{s:s, s:s, s:o, s:[], s:[]}", "check", "probe",
                                       "participant", names[i], "exr",
                                       frames[i] ? json_pack("[s]", frames[i]) : json_array(),
                                       "pictures", "differences"));
    return json_pack("{s:[{s:s, s:[o]}], s:o}", "checks", "name", "probe", "views",
                     neph_physics_view_json(&view, truth), "rows", rows);
}

static const char *picture_of(const json_t *physics, size_t row, const char *kind)
{
    const json_t *rows = json_object_get(physics, "rows");
    return json_string_value(json_array_get(json_object_get(json_array_get(rows, row), kind), 0));
}

static bool same_bytes(const struct scratch *scratch, const char *a, const char *b)
{
    const char *const names[2] = {a, b};
    char path[SCRATCH_PATH_MAX], *bytes[2];
    size_t sizes[2];
    struct neph_diag diag = {.line = 0};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof(path), "%s/%s", scratch->folder, names[i]);
        neph_assert_ok(neph_file_read(path, 65536, &bytes[i], &sizes[i], &diag), &diag);
    }
    const bool same = sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0;
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

static void test_view_says_what_it_needs(void **state)
{
    (void)state;
    double truth[PIXELS];
    fill_truth(truth);
    json_t *json = neph_physics_view_json(&view, truth);
    assert_string_equal(json_string_value(json_object_get(json, "what")),
                        "camera looks 50° down, 60° aside from the sun, which stands 30° high");
    /* Mean 0.1 + 0.01 * 11.5; brightest 0.33: 0.9 / 0.33 = 2^1.447, so 1 EV in half stops. */
    neph_assert_close(json_number_value(json_object_get(json, "difference_scale")), 0.0215, 1e-12,
                      0.0);
    assert_true(json_number_value(json_object_get(json, "exposure_ev")) == 1.0);
    assert_int_equal(json_array_size(json_object_get(json, "truth")), PIXELS);
    json_decref(json);
}

static void test_black_view_has_a_scale(void **state)
{
    (void)state;
    const double truth[PIXELS] = {0.0};
    json_t *json = neph_physics_view_json(&view, truth);
    assert_true(json_number_value(json_object_get(json, "difference_scale")) > 0.0);
    assert_true(json_number_value(json_object_get(json, "exposure_ev")) == 0.0);
    json_decref(json);
}

static void test_every_frame_is_drawn(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_diag diag = {.line = 0};
    const char *const names[4] = {"right", "too dark", "too bright", "absent"};
    const double factors[3] = {1.0, 0.95, 1.05};
    char paths[3][SCRATCH_PATH_MAX];
    const char *frames[4] = {paths[0], paths[1], paths[2], NULL};
    for (int i = 0; i < 3; i++) {
        snprintf(paths[i], sizeof(paths[i]), "%s/frame_%d.exr", scratch->folder, i);
        write_frame(paths[i], WIDTH, factors[i]);
    }
    json_t *physics = document(names, frames, 4);
    neph_assert_ok(neph_physics_pictures(physics, scratch->folder, &diag), &diag);

    const json_t *views = json_object_get(json_array_get(json_object_get(physics, "checks"), 0),
                                          "views");
    const json_t *drawn = json_array_get(views, 0);
    assert_null(json_object_get(drawn, "truth"));
    const char *truth = json_string_value(json_object_get(drawn, "picture"));
    assert_string_equal(truth, "images/physics/probe/truth_0.png");
    assert_string_equal(picture_of(physics, 1, "pictures"), "images/physics/probe/too_dark_0.png");
    assert_string_equal(picture_of(physics, 1, "differences"),
                        "images/physics/probe/too_dark_0_difference.png");
    assert_null(picture_of(physics, 3, "pictures"));
    assert_true(same_bytes(scratch, truth, picture_of(physics, 0, "pictures")));
    assert_false(same_bytes(scratch, truth, picture_of(physics, 1, "pictures")));
    assert_false(same_bytes(scratch, picture_of(physics, 1, "differences"),
                            picture_of(physics, 2, "differences")));

    json_t *once = json_deep_copy(
        physics); /* a report that is published again draws nothing twice */
    neph_assert_ok(neph_physics_pictures(physics, scratch->folder, &diag), &diag);
    assert_true(json_equal(physics, once));
    json_decref(once);
    json_decref(physics);
}

static void test_frame_of_another_size_is_refused(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_diag diag = {.line = 0};
    char path[SCRATCH_PATH_MAX];
    const char *const names[1] = {"narrow"};
    const char *const frames[1] = {path};
    snprintf(path, sizeof(path), "%s/narrow.exr", scratch->folder);
    write_frame(path, WIDTH - 1, 1.0);
    json_t *physics = document(names, frames, 1);
    assert_int_equal(neph_physics_pictures(physics, scratch->folder, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "probe"));
    json_decref(physics);
}

static void test_no_suite_is_no_work(void **state)
{
    const struct scratch *scratch = *state;
    assert_int_equal(neph_physics_pictures(NULL, scratch->folder, NULL), NEPH_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_view_says_what_it_needs),
        cmocka_unit_test(test_black_view_has_a_scale),
        scratch_test(test_every_frame_is_drawn),
        scratch_test(test_frame_of_another_size_is_refused),
        scratch_test(test_no_suite_is_no_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

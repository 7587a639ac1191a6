/* SPDX-License-Identifier: MIT
 *
 * The images of the physics suite: drawn once for every view and row with a frame, named in the
 * results, in the truth's size.
 */
#include "tests/base/scratch.h"
#include "tests/harness/image_test.h"

#include "harness/physics/images.h"

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

/* A frame with the truth times `factor`. */
static void write_frame(const char *path, int width_px, double factor)
{
    struct neph_image *image = grey_image(width_px, HEIGHT, 0.0);
    double truth[PIXELS];
    fill_truth(truth);
    for (int p = 0; p < width_px * HEIGHT; p++)
        set_grey(image, (size_t)p, truth[p] * factor);
    write_image(path, image);
}

enum { ROWS_MAX = 4 };

/* A suite of one check, with one row per frame; a NULL frame was not rendered. */
struct suite {
    double truth[PIXELS];
    struct neph_participant participants[ROWS_MAX];
    struct neph_physics_check check;
    struct neph_physics_row rows[ROWS_MAX];
    struct neph_physics physics;
};

static void fill_suite(struct suite *suite, const char *const *names, const char *const *frames,
                       int count)
{
    memset(suite, 0, sizeof(*suite));
    fill_truth(suite->truth);
    suite->check = (struct neph_physics_check){.name = "probe", .view_count = 1};
    neph_physics_view_describe(&view, suite->truth, &suite->check.views[0]);
    suite->physics = (struct neph_physics){
        .check_count = 1, .checks = &suite->check, .row_count = count, .rows = suite->rows};
    for (int i = 0; i < count; i++) {
        suite->participants[i].name = names[i];
        suite->rows[i].check = &suite->check;
        suite->rows[i].participant = &suite->participants[i];
        suite->rows[i].paths[0] = frames[i];
    }
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

static void test_view_has_its_requirements(void **state)
{
    double truth[PIXELS];
    struct neph_physics_view described;
    fill_truth(truth);
    neph_physics_view_describe(&view, truth, &described);
    assert_string_equal(described.what,
                        "camera looks 50° down, 60° aside from the sun, which stands 30° high");
    /* Mean 0.1 + 0.01 * 11.5; maximum 0.33: 0.9 / 0.33 = 2^1.447, so 1 EV in half stops. */
    neph_assert_close(described.difference_scale, 0.0215, 1e-12, 0.0);
    assert_true(described.exposure_ev == 1.0);
}

static void test_black_view_has_a_scale(void **state)
{
    const double truth[PIXELS] = {0.0};
    struct neph_physics_view described;
    neph_physics_view_describe(&view, truth, &described);
    assert_true(described.difference_scale > 0.0);
    assert_true(described.exposure_ev == 0.0);
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
    struct suite suite;
    const struct neph_physics_row *rows = suite.rows;
    fill_suite(&suite, names, frames, 4);
    neph_assert_ok(neph_physics_images(&suite.physics, scratch->folder, &diag), &diag);

    const char *truth = suite.check.views[0].picture;
    assert_string_equal(truth, "images/physics/probe/truth_0.png");
    assert_string_equal(rows[1].pictures[0], "images/physics/probe/too_dark_0.png");
    assert_string_equal(rows[1].differences[0], "images/physics/probe/too_dark_0_difference.png");
    assert_null(rows[3].pictures[0]);
    assert_true(same_bytes(scratch, truth, rows[0].pictures[0]));
    assert_false(same_bytes(scratch, truth, rows[1].pictures[0]));
    assert_false(same_bytes(scratch, rows[1].differences[0], rows[2].differences[0]));

    /* Publishing a report again draws nothing twice. */
    suite.rows[0].paths[0] = "/nowhere.exr";
    neph_assert_ok(neph_physics_images(&suite.physics, scratch->folder, &diag), &diag);
    neph_physics_finish(&suite.physics);
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
    struct suite suite;
    fill_suite(&suite, names, frames, 1);
    assert_int_equal(neph_physics_images(&suite.physics, scratch->folder, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "probe"));
    neph_physics_finish(&suite.physics);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_view_has_its_requirements),
        cmocka_unit_test(test_black_view_has_a_scale),
        scratch_test(test_every_frame_is_drawn),
        scratch_test(test_frame_of_another_size_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

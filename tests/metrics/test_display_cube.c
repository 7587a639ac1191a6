/* SPDX-License-Identifier: MIT
 *
 * A view of an OpenColorIO config that the test writes, baked: its nodes against the closed form.
 */
#include "tests/base/scratch.h"
#include "tests/neph_test.h"

#include "base/files.h"
#include "metrics/display_cube.h"

/* Swaps red and blue, which no table of curves can do; then a curve. */
static const char config_text[] =
    "ocio_profile_version: 2\n"
    "roles: {default: linear, scene_linear: linear}\n"
    "file_rules:\n"
    "  - !<Rule> {name: Default, colorspace: default}\n"
    "displays:\n"
    "  screen:\n"
    "    - !<View> {name: swapped, colorspace: swapped}\n"
    "    - !<View> {name: raw, colorspace: linear}\n"
    "    - !<View> {name: torn, colorspace: torn}\n"
    "colorspaces:\n"
    "  - !<ColorSpace> {name: linear}\n"
    "  - !<ColorSpace>\n"
    "    name: swapped\n"
    "    from_scene_reference: !<GroupTransform>\n"
    "      children:\n"
    "        - !<MatrixTransform> {matrix: [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]}\n"
    "        - !<ExponentTransform> {value: [2, 2, 2, 1], direction: inverse}\n"
    "  - !<ColorSpace>\n"
    "    name: torn\n"
    "    from_scene_reference: !<FileTransform> {src: torn.cube, interpolation: nearest}\n";

/* One of its eight colours is NaN. */
static const char torn_text[] = "LUT_3D_SIZE 2\n"
                                "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\nnan nan nan\n";

enum { SIDE = NEPH_DISPLAY_CUBE_SIDE };

static struct neph_display_choice write_display_choice(void **state, char path[SCRATCH_PATH_MAX])
{
    neph_assert_ok(neph_file_write(scratch_path(state, path, "config.ocio"), config_text,
                                   strlen(config_text), NULL),
                   NULL);
    return (struct neph_display_choice){.config = path};
}

static void test_nodes_are_the_view(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const struct neph_display_choice choice = write_display_choice(state, path);
    struct neph_display_cube cube;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_display_cube_bake(&choice, &cube, &diag), &diag);
    assert_string_equal(cube.name, "swapped on screen"); /* the config's default view */
    for (int i = 0; i < SIDE * SIDE * SIDE; i += 37) {
        const int steps[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int c = 0; c < 3; c++) {
            const double place = (double)steps[2 - c] / (SIDE - 1); /* of the swapped channel */
            const double linear = cube.knee * (pow(1.0 + cube.top / cube.knee, place) - 1.0);
            neph_assert_close((double)cube.nodes[c][i], 255.0 * sqrt(linear), 1e-5, 0.01);
        }
    }
    /* A root bends most between the first two nodes: at a quarter of the interval it is at 1/2. */
    const double second = (double)cube.nodes[1][SIDE];
    assert_true(cube.error_max > 0.1 * second && cube.error_max < 0.26 * second);
    assert_true(cube.error_mean > 0.0 && cube.error_mean < 0.3);
    neph_display_cube_finish(&cube);
}

static void test_a_view_by_name(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_display_choice choice = write_display_choice(state, path);
    struct neph_display_cube cube;
    struct neph_diag diag = {0};
    choice.display = "screen";
    choice.view = "raw";
    choice.space = "linear";
    neph_assert_ok(neph_display_cube_bake(&choice, &cube, &diag), &diag);
    assert_string_equal(cube.name, "raw on screen");
    neph_assert_close((double)cube.nodes[0][SIDE - 1], 255.0 * cube.top, 1e-6, 0);
    neph_assert_close((double)cube.nodes[2][SIDE - 1], 0.0, 0, 0); /* pure red stays pure red */
    neph_display_cube_finish(&cube);
}

/* With the role aces_interchange the values of the view "light", which is linear Rec.709 by the
 * matrix of the ACES configs of OpenColorIO, are those of the axes, whatever scene_linear is. */
static const char aces_text[] =
    "ocio_profile_version: 2\n"
    "roles: {aces_interchange: aces, scene_linear: aces}\n"
    "file_rules:\n"
    "  - !<Rule> {name: Default, colorspace: aces}\n"
    "displays: {screen: [!<View> {name: plain, colorspace: light}]}\n"
    "colorspaces:\n"
    "  - !<ColorSpace> {name: aces}\n"
    "  - !<ColorSpace>\n"
    "    name: light\n"
    "    from_scene_reference: !<MatrixTransform> {matrix: [\n"
    "      2.52168618674388, -1.13413098823972, -0.387555198504164, 0,\n"
    "      -0.276479914229922, 1.37271908766826, -0.096239173438334, 0,\n"
    "      -0.0153780649660342, -0.152975335867399, 1.16835340083343, 0, 0, 0, 0, 1]}\n";

static void test_rec709_is_found_by_the_interchange_role(void **state)
{
    char path[SCRATCH_PATH_MAX];
    const struct neph_display_choice choice = {.config = scratch_path(state, path, "aces.ocio")};
    struct neph_display_cube cube;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_write(path, aces_text, strlen(aces_text), NULL), NULL);
    neph_assert_ok(neph_display_cube_bake(&choice, &cube, &diag), &diag);
    for (int i = 0; i < SIDE * SIDE * SIDE; i += 37) {
        const int steps[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int c = 0; c < 3; c++) {
            const double place = (double)steps[c] / (SIDE - 1);
            const double linear = cube.knee * (pow(1.0 + cube.top / cube.knee, place) - 1.0);
            /* the largest channel in single precision, by a matrix */
            neph_assert_close((double)cube.nodes[c][i], 255.0 * linear, 0.0,
                              255.0 * cube.top * 16.0 * 0x1p-24);
        }
    }
    neph_display_cube_finish(&cube);
}

/* Colours that are NaN are counted; OpenColorIO itself treats them as 0. */
static void test_a_view_that_gives_no_numbers(void **state)
{
    char path[SCRATCH_PATH_MAX], torn[SCRATCH_PATH_MAX];
    struct neph_display_choice choice = write_display_choice(state, path);
    struct neph_display_cube cube;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_file_write(scratch_path(state, torn, "torn.cube"), torn_text, strlen(torn_text), NULL),
        NULL);
    choice.view = "torn";
    neph_assert_ok(neph_display_cube_bake(&choice, &cube, &diag), &diag);
    assert_int_equal(cube.not_numbers, 1);
    for (int i = 0; i < 3 * SIDE * SIDE * SIDE; i++)
        assert_true(isfinite(cube.nodes[0][i]));
    neph_display_cube_finish(&cube);
    choice.view = "raw";
    neph_assert_ok(neph_display_cube_bake(&choice, &cube, &diag), &diag);
    assert_int_equal(cube.not_numbers, 0);
    neph_display_cube_finish(&cube);
}

static void refuse(struct neph_display_choice choice, enum neph_status wanted, const char *told)
{
    struct neph_display_cube cube = {.knee = 7.0};
    struct neph_diag diag = {0};
    assert_int_equal(neph_display_cube_bake(&choice, &cube, &diag), wanted);
    if (!strstr(diag.message, told))
        fail_msg("'%s' is not in '%s'", told, diag.message);
    assert_true(cube.knee == 7.0);
}

static void test_refusals_list_available_names(void **state)
{
    char path[SCRATCH_PATH_MAX], other[SCRATCH_PATH_MAX];
    const struct neph_display_choice whole = write_display_choice(state, path);
    struct neph_display_choice wrong = whole;
    wrong.view = "film";
    refuse(wrong, NEPH_ERR_INPUT, "no view 'film'; it has swapped, raw, torn");
    wrong = whole;
    wrong.display = "wall";
    wrong.view = "raw";
    refuse(wrong, NEPH_ERR_INPUT, "no display 'wall'; it has screen");
    wrong = whole;
    wrong.space = "ACES";
    refuse(wrong, NEPH_ERR_INPUT, "no color space 'ACES'");
    wrong.config = scratch_path(state, other, "nowhere.ocio");
    refuse(wrong, NEPH_ERR_NOT_FOUND, other);
    neph_assert_ok(neph_file_write(other, "- no config\n", 12, NULL), NULL);
    refuse(wrong, NEPH_ERR_INPUT, other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_nodes_are_the_view),
        scratch_test(test_a_view_by_name),
        scratch_test(test_rec709_is_found_by_the_interchange_role),
        scratch_test(test_a_view_that_gives_no_numbers),
        scratch_test(test_refusals_list_available_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

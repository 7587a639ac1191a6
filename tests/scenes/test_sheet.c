/* SPDX-License-Identifier: MIT
 *
 * Thin layers, and repeated grids: perpendicular and slanted rays, in closed form.
 */
#include "tests/base/scratch.h"
#include "tests/scene_builders.h"

#include "base/files.h"
#include "scenes/grid.h"
#include "scenes/media.h"
#include "scenes/scene.h"
#include "scenes/sheet.h"

#include <stdlib.h>

/* A scene with these lines as its media. */
static enum neph_status load_media(const char *media, struct neph_scene **scene,
                                   struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-sheet-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml");
    char *text = neph_format(
        "name: probe\ntitle: t\nphysics: p\n"
        "camera: {position_m: [0, 1, 5], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\nmedia:\n%s",
        media);
    scratch_write(path, text, strlen(text));
    *scene = NULL;
    const enum neph_status status = neph_scene_load(path, scene, diag);
    free(text);
    free(path);
    neph_dir_remove(folder, NULL);
    return status;
}

static struct neph_scene *loaded(const char *media)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(load_media(media, &scene, &diag), &diag);
    return scene;
}

static double depth_along(const struct neph_medium *medium, struct neph_vec3 from_m,
                          struct neph_vec3 direction)
{
    return neph_medium_optical_depth(medium, from_m, neph_vec3_normalize(direction), 0.0, INFINITY);
}

/* --- sheets ---------------------------------------------------------------------------------- */

static void test_a_sheet_has_its_optical_depth(void **state)
{
    struct neph_scene *scene = loaded(
        "  - sheet: {center_m: [3, 50, -2], side_m: 400, thickness_m: 0.5, optical_depth: 0.3,\n"
        "      nodes: 20, albedo: [1, 1, 1]}\n");
    const struct neph_medium *sheet = &scene->media[0];
    uint64_t seed = 1;
    for (int i = 0; i < 300; i++) {
        const struct neph_vec3 direction = random_direction(&seed);
        const double cosine = fabs(direction.y);
        if (cosine < 0.4) /* others leave it near or at a rim */
            continue;
        const double sign = direction.y > 0.0 ? 1.0 : -1.0;
        const struct neph_vec3 before_m = {3.0, 50.0 - sign * 60.0, -2.0}, middle_m = {9, 50, 4};
        const struct neph_vec3 behind_m = {3.0, 50.0 + sign * 0.2501, -2.0};
        assert_float_equal(depth_along(sheet, before_m, direction), 0.3 / cosine, 1e-12);
        assert_float_equal(depth_along(sheet, middle_m, direction), 0.15 / cosine, 1e-12);
        assert_float_equal(depth_along(sheet, behind_m, direction), 0.0, 0.0);
    }
    neph_scene_destroy(scene);
}

/* Perpendicular through a node it has the pattern's value; between nodes it is linear. */
static void test_a_sheet_has_its_pattern(void **state)
{
    enum { NODES = 64 };
    const struct neph_sheet wanted = {.center_m = {0.0, 7000.0, 0.0},
                                      .side_m = 16000.0,
                                      .thickness_m = 400.0,
                                      .nodes = NODES,
                                      .pattern = NEPH_SHEET_STREAKS,
                                      .seed = 3,
                                      .wisp_m = 1500.0,
                                      .stretch = 4.0,
                                      .along = {2.0, 0.0, 1.0},
                                      .coverage = 0.5};
    struct neph_scene *scene = loaded(
        "  - sheet: {center_m: [0, 7000, 0], side_m: 16000, thickness_m: 400, optical_depth: 0.8,\n"
        "      nodes: 64, pattern: streaks, seed: 3, wisp_m: 1500, stretch: 4, along: [2, 0, 1],\n"
        "      coverage: 0.5, albedo: [1, 1, 1]}\n");
    const struct neph_vec3 up = {0.0, 1.0, 0.0};
    int clear = 0;
    double before = 0.0, largest = 0.0;
    for (int k = 0; k < NODES; k++)
        for (int i = 0; i < NODES; i++) {
            const struct neph_vec3 at_m = {250.0 * (i - 31.5), 7000.0, 250.0 * (k - 31.5)};
            const double value = neph_sheet_value(&wanted, at_m);
            const struct neph_vec3 foot_m = {at_m.x, 0.0, at_m.z};
            assert_float_equal(depth_along(&scene->media[0], foot_m, up), 0.8 * value, 1e-6);
            const struct neph_vec3 half_m = {at_m.x - 125.0, 0.0, at_m.z};
            if (i > 0)
                assert_float_equal(depth_along(&scene->media[0], half_m, up),
                                   0.4 * (value + before), 1e-6);
            before = value;
            clear += value == 0.0;
            largest = fmax(largest, value);
        }
    neph_assert_in_range(clear, NODES * NODES / 4, 3 * NODES * NODES / 4);
    assert_true(largest > 0.8 && largest <= 1.0);
    neph_scene_destroy(scene);
}

/* Above a height, along the y axis through a position. */
static double depth_above(const struct neph_medium *medium, double x_m, double y_m, double z_m)
{
    const struct neph_vec3 from_m = {x_m, y_m, z_m}, up = {0.0, 1.0, 0.0};
    return depth_along(medium, from_m, up);
}

/* Vertically it has the level sheet's optical depth, and its middle has the same distance from the
 * planet's centre everywhere: the integral of the part above, exact by Simpson's rule from node to
 * node. */
static void test_a_sheet_goes_around_a_planet(void **state)
{
    enum { NODES = 41 };
    const double half_m = 150.0, radius_m = 6.36e6, top_m = 9000.0, spacing_m = 200000.0 / NODES;
    struct neph_scene *scene = loaded(
        "  - sheet: {center_m: [0, 9000, 0], side_m: 200000, thickness_m: 300, nodes: 41,\n"
        "      planet_radius_m: 6360000, optical_depth: 0.4, albedo: [1, 1, 1]}\n");
    const struct neph_medium *sheet = &scene->media[0];
    for (int k = 0; k < NODES; k += 5)
        for (int i = 0; i < NODES; i += 4) {
            const double x_m = spacing_m * (i - 20), z_m = spacing_m * (k - 20);
            const double wanted_m =
                sqrt((radius_m + top_m) * (radius_m + top_m) - x_m * x_m - z_m * z_m) - radius_m;
            double moment = 0.0, low_m = top_m - 20.0 * half_m;
            assert_float_equal(depth_above(sheet, x_m, low_m, z_m), 0.4, 1e-6);
            assert_float_equal(depth_above(sheet, x_m, wanted_m + 2.0 * half_m, z_m), 0.0, 1e-9);
            for (int j = 0; j < 22; j++)
                moment += half_m / 6.0 *
                          (depth_above(sheet, x_m, low_m + j * half_m, z_m) +
                           4.0 * depth_above(sheet, x_m, low_m + (j + 0.5) * half_m, z_m) +
                           depth_above(sheet, x_m, low_m + (j + 1.0) * half_m, z_m));
            assert_float_equal(low_m + moment / 0.4, wanted_m, 0.01);
        }
    neph_scene_destroy(scene);
}

/* --- repeated grids -------------------------------------------------------------------------- */

/* One node, repeated often: far from its rims a slab, with a ramp on either side. */
static void test_a_repeated_node_is_a_slab(void **state)
{
    struct neph_scene *scene = loaded(
        "  - grid: {size: [1, 2, 1], origin_m: [-512, 10, -512], spacing_m: [1, 4, 1],\n"
        "      repeat: [1024, 1, 1024], values: [1, 1], extinction_per_m: 0.1,\n"
        "      albedo: [1, 1, 1]}\n");
    uint64_t seed = 2;
    for (int i = 0; i < 200; i++) {
        struct neph_vec3 direction = random_direction(&seed);
        direction.y = 0.2 + fabs(direction.y);
        direction = neph_vec3_normalize(direction);
        /* Eight metres of it: four, and half of four below and above. */
        assert_float_equal(depth_along(&scene->media[0], (struct neph_vec3){0, 0, 0}, direction),
                           0.1 * 8.0 / direction.y, 1e-11);
    }
    neph_scene_destroy(scene);
}

/* Perpendicular through its nodes a checkerboard has its values, and the mean halfway between them;
 * moved by a period it is the same. */
static void test_a_checkerboard_repeats(void **state)
{
    struct neph_scene *scene = loaded(
        "  - grid: {size: [2, 1, 2], origin_m: [0, 10, 0], spacing_m: [3, 1, 3],\n"
        "      repeat: [50, 1, 50], values: [1, 0, 0, 1], extinction_per_m: 0.7,\n"
        "      albedo: [1, 1, 1]}\n");
    const struct neph_medium *board = &scene->media[0];
    const struct neph_vec3 up = {0.0, 1.0, 0.0};
    for (int k = 0; k < 100; k++)
        for (int i = 0; i < 100; i++) {
            const struct neph_vec3 node_m = {3.0 * i, 0.0, 3.0 * k};
            const struct neph_vec3 middle_m = {3.0 * i + 1.5, 0.0, 3.0 * k};
            const double value = (i + k) % 2 == 0 ? 0.7 : 0.0;
            assert_float_equal(depth_along(board, node_m, up), value, 1e-12);
            if (i < 99)
                assert_float_equal(depth_along(board, middle_m, up), 0.35, 1e-12);
        }
    uint64_t seed = 6;
    for (int i = 0; i < 200; i++) {
        struct neph_vec3 direction = random_direction(&seed);
        direction.y = 0.3 + fabs(direction.y);
        const struct neph_vec3 from_m = {neph_test_uniform(&seed, 120, 150), 0.0,
                                         neph_test_uniform(&seed, 120, 150)};
        const struct neph_vec3 moved_m = neph_vec3_add(from_m, (struct neph_vec3){-12.0, 0.0, 6.0});
        assert_float_equal(depth_along(board, from_m, direction),
                           depth_along(board, moved_m, direction), 1e-11);
    }
    neph_scene_destroy(scene);
}

/* By default a grid occurs once. */
static void test_a_grid_is_there_once(void **state)
{
    struct neph_scene *scene = loaded(
        "  - grid: {size: [2, 1, 3], origin_m: [0, 10, 0], spacing_m: [3, 1, 3],\n"
        "      values: [1, 2, 3, 4, 5, 6], extinction_per_m: 0.7, albedo: [1, 1, 1]}\n");
    const struct neph_grid *grid = scene->media[0].grid;
    assert_true(grid->size[0] == 2 && grid->size[1] == 1 && grid->size[2] == 3);
    for (int i = 0; i < 6; i++)
        assert_float_equal(grid->values[i], i + 1, 0.0);
    neph_scene_destroy(scene);
}

/* Infinite along two axes it equals a hundred copies, as far as these reach: densities, integrals
 * and bounds. */
static void test_without_end(void **state)
{
    static const char form[] =
        "  - grid: {size: [3, 2, 2], origin_m: [%s], spacing_m: [3, 2, 5], repeat: [%s],\n"
        "      values: [1, 0, 4, 2, 2, 0, 3, 1, 0, 0, 5, 2], extinction_per_m: 0.01,\n"
        "      albedo: [1, 1, 1]}\n";
    char *endless_text = neph_format(form, "4, 10, -7", "0, 1, 0"),
         *finite_text = neph_format(form, "-446, 10, -507", "100, 1, 100");
    struct neph_scene *endless = loaded(endless_text), *finite = loaded(finite_text);
    const struct neph_medium *a = &endless->media[0], *b = &finite->media[0];
    uint64_t seed = 9;
    for (int i = 0; i < 500; i++) {
        struct neph_vec3 direction = random_direction(&seed);
        const struct neph_vec3 from_m = {neph_test_uniform(&seed, -200, 200),
                                         neph_test_uniform(&seed, 5, 15),
                                         neph_test_uniform(&seed, -200, 200)};
        const struct neph_vec3 side_m = {neph_test_uniform(&seed, 0.1, 20), 1.0,
                                         neph_test_uniform(&seed, 0.1, 20)};
        const struct neph_bounds box = {from_m, neph_vec3_add(from_m, side_m)};
        neph_assert_close(neph_medium_extinction_per_m(a, from_m),
                          neph_medium_extinction_per_m(b, from_m), 1e-12, 1e-12);
        neph_assert_close(neph_medium_optical_depth(a, from_m, direction, 0.0, 100.0),
                          neph_medium_optical_depth(b, from_m, direction, 0.0, 100.0), 1e-11, 0.0);
        neph_assert_close(neph_grid_maximum_in(a->grid, &box), neph_grid_maximum_in(b->grid, &box),
                          1e-9, 0.0);
        assert_true(neph_grid_node_maximum_in(a->grid, &box) >=
                    neph_grid_maximum_in(a->grid, &box) * (1.0 - 1e-9));
    }
    assert_true(neph_medium_is_endless(a) && !neph_medium_is_endless(b));
    assert_string_not_equal(endless->hash, finite->hash);
    neph_scene_destroy(finite);
    neph_scene_destroy(endless);
    free(finite_text);
    free(endless_text);
}

/* Far from its origin, too, and on a ray through everything. */
static void test_without_end_everywhere(void **state)
{
    struct neph_scene *scene = loaded(
        "  - grid: {size: [2, 2, 1], origin_m: [0, 10, 0], spacing_m: [500, 4, 3],\n"
        "      repeat: [0, 1, 0], values: [1, 3, 1, 3], extinction_per_m: 0.1,\n"
        "      albedo: [1, 1, 1]}\n");
    const struct neph_vec3 up = {0.0, 1.0, 0.0};
    for (int k = -900; k <= 900; k += 100) {
        const struct neph_vec3 at_m = {1000.0 * k + 250.0, 0.0, 999.0 * k + 1.0};
        assert_float_equal(depth_along(&scene->media[0], at_m, up), 0.1 * 8.0 * 2.0, 1e-9);
    }
    const struct neph_vec3 in_m = {0.0, 12.0, 0.0};
    assert_float_equal(depth_along(&scene->media[0], in_m, (struct neph_vec3){1.0, 0.0, 0.0}) /
                           (0.1 * 2.0 * 1e6),
                       1.0, 1e-9);
    neph_scene_destroy(scene);
}

static void test_what_is_refused(void **state)
{
    static const struct {
        const char *media, *words;
    } cases[] = {
        {"  - sheet: {center_m: [0, 50, 0], side_m: 400, thickness_m: 1,\n"
         "      planet_radius_m: 300, optical_depth: 1, albedo: [1, 1, 1]}\n",
         "too small"},
        {"  - sheet: {center_m: [0, 9, 0], side_m: 4, thickness_m: 1,\n"
         "      optical_depth: 1, along: [0, 1, 0], albedo: [1, 1, 1]}\n",
         "level direction"},
        {"  - grid: {size: [2, 1, 2], origin_m: [0, 10, 0], spacing_m: [3, 1, 3],\n"
         "      repeat: [513, 1, 1], values: [1, 0, 0, 1],\n"
         "      extinction_per_m: 0.7, albedo: [1, 1, 1]}\n",
         "1026 x 1 x 2"},
        {"  - grid: {size: [1, 1, 1], origin_m: [0, 10, 0], spacing_m: [0.001, 1, 1],\n"
         "      repeat: [0, 1, 1], values: [1],\n"
         "      extinction_per_m: 0.7, albedo: [1, 1, 1]}\n",
         "without end"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {0};
        assert_int_equal(load_media(cases[i].media, &scene, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, cases[i].words));
    }
}

#include "tests/main.h"

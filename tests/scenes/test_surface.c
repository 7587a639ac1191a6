/* SPDX-License-Identifier: MIT
 *
 * Surfaces of solids: patterns by hand and by an independent pcg3d, keys and refused values, and
 * unchanged hashes of plain solids.
 */
#include "tests/scene_builders.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"

#include <string.h>

/* ---- patterns -------------------------------------------------------------------------------- */

/* Computed in Python from the paper's listing. */
static void test_noise_is_pcg3d(void **state)
{
    assert_true(neph_noise_value(0, 0, 0) == 10203095 * 0x1p-24);
    assert_true(neph_noise_value(3, 1, 2) == 16424825 * 0x1p-24);
    assert_true(neph_noise_value(1000000000, 31, 5) == 12210007 * 0x1p-24);
    assert_true(neph_noise_value(1000000000, -1, 5 - NEPH_NOISE_CELLS) == 12210007 * 0x1p-24);
}

static void test_noise_is_bilinear_and_uniform(void **state)
{
    const struct neph_paint noise = {.cell_m = 1, .pattern = NEPH_PATTERN_NOISE, .seed = 7};
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < NEPH_NOISE_CELLS; i++)
        for (int j = 0; j < NEPH_NOISE_CELLS; j++) {
            const double a = neph_noise_value(7, i, j), b = neph_noise_value(7, i + 1, j);
            const double c = neph_noise_value(7, i, j + 1), d = neph_noise_value(7, i + 1, j + 1);
            sum += a;
            squares += a * a;
            assert_true(neph_paint_value(&noise, i, j) == a);
            neph_assert_close(neph_paint_value(&noise, i + 0.25, j), 0.75 * a + 0.25 * b, 1e-15,
                              0.0);
            neph_assert_close(neph_paint_value(&noise, i + 0.5, j + 0.5 - NEPH_NOISE_CELLS),
                              0.25 * (a + b + c + d), 1e-15, 0.0);
        }
    /* 1024 uniform numbers: mean 1/2 and mean square 1/3, within four standard errors. */
    neph_assert_close(sum / 1024, 0.5, 0.0, 4 * sqrt(1.0 / 12.0 / 1024));
    neph_assert_close(squares / 1024, 1.0 / 3.0, 0.0, 4 * sqrt(4.0 / 45.0 / 1024));
}

static void test_a_checker_by_hand(void **state)
{
    const struct neph_paint checker = {.cell_m = 1, .pattern = NEPH_PATTERN_CHECKER};
    static const struct {
        double u, v, value;
    } places[] = {{0.5, 0.5, 0},  {1.5, 0.5, 1},   {0.5, 1.5, 1},  {1.5, 1.5, 0},
                  {-0.5, 0.5, 1}, {-0.5, -0.5, 0}, {0.5, -1.5, 0}, {-7.5, 1000000.5, 0}};
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++)
        assert_true(neph_paint_value(&checker, places[i].u, places[i].v) == places[i].value);
}

static double colour_seen(const struct neph_solid *solid, struct neph_vec3 from_m,
                          struct neph_vec3 direction)
{
    struct neph_solid one = *solid;
    const struct neph_scene scene = {.solid_count = 1, .solids = &one};
    const struct neph_hit hit = neph_scene_hit(&scene, from_m, direction);
    assert_non_null(hit.solid);
    return neph_surface_color(&hit, neph_vec3_along(from_m, direction, hit.t_m)).r;
}

/* By the two coordinates in a face, from the middle of the box, whose faces lie on lines of the
 * pattern; and the same on the box after it has moved and rotated. */
static void test_a_pattern_is_painted_on_faces(void **state)
{
    struct neph_solid box = make_box(10, 0, 0, 14, 2, 8);
    box.albedo = make_grey(0.25);
    box.surface.texture = (struct neph_paint){
        .cell_m = 0.5, .pattern = NEPH_PATTERN_NOISE, .other = make_grey(0.75), .seed = 5};
    const struct neph_paint *texture = &box.surface.texture;
    const struct neph_vec3 middle_m = {12, 1, 4};
    const double turn_rad = 0.7;
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            const double at[3] = {axis == 0 ? 5.0 * side : 0.3, axis == 1 ? 5.0 * side : 0.2,
                                  axis == 2 ? 9.0 * side : -1.3};
            const double way[3] = {axis == 0 ? -side : 0, axis == 1 ? -side : 0,
                                   axis == 2 ? -side : 0};
            const double value = neph_paint_value(texture, 2.0 * (axis == 0 ? at[1] : at[0]),
                                                  2.0 * (axis == 2 ? at[1] : at[2]));
            const struct neph_vec3 from_m = {at[0], at[1], at[2]}, d = {way[0], way[1], way[2]};
            neph_assert_close(colour_seen(&box, neph_vec3_add(middle_m, from_m), d),
                              0.25 + 0.5 * value, 1e-13, 0.0);
            struct neph_solid turned = box;
            turned.turn = (struct neph_turn){1, cos(turn_rad), sin(turn_rad)};
            const struct neph_vec3 there_m = neph_turned(&turned.turn, from_m);
            neph_assert_close(colour_seen(&turned, neph_vec3_add(middle_m, there_m),
                                          neph_turned(&turned.turn, d)),
                              0.25 + 0.5 * value, 1e-13, 0.0);
        }
}

/* ---- keys ------------------------------------------------------------------------------------ */

static const char head[] =
    "name: probe\ntitle: a probe\nphysics: none\n"
    "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
    "sun: {direction: [0, 2, 0], irradiance_w_per_m2: [3, 3, 3]}\n";

/* A scene of one solid, of one kind, with additional keys. */
static enum neph_status load(const char *scattering, const char *solid, const char *keys,
                             struct neph_scene **scene, struct neph_diag *diag)
{
    static const char box[] = "box: {min_m: [0, 0, 0], max_m: [1, 1, 1]";
    static const char sphere[] = "sphere: {center_m: [0, 0, 0], radius_m: 1";
    char folder[] = "/tmp/neph-surface-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, "probe.yaml");
    char *text = neph_format("%sscattering: %s\nsolids: [%s, albedo: [0.5, 0.5, 0.5]%s}]\n", head,
                             scattering, strcmp(solid, "box") == 0 ? box : sphere, keys);
    assert_int_equal(neph_file_write(path, text, strlen(text), NULL), NEPH_OK);
    *scene = NULL;
    const enum neph_status status = neph_scene_load(path, scene, diag);
    free(text);
    free(path);
    neph_dir_remove(folder, NULL);
    return status;
}

static struct neph_scene *loaded(const char *solid, const char *keys)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(load("multiple", solid, keys, &scene, &diag), &diag);
    return scene;
}

static void test_keys_are_read(void **state)
{
    struct neph_scene *scene = loaded(
        "box", ", metalness: 0.75, roughness: 0.3,\n"
               "  texture: {pattern: noise, cell_m: 0.2, albedo: [1, 0.5, 0], seed: 9}");
    const struct neph_surface *surface = &scene->solids[0].surface;
    assert_true(surface->metalness == 0.75 && surface->roughness == 0.3);
    assert_true(surface->texture.pattern == NEPH_PATTERN_NOISE && surface->texture.seed == 9);
    assert_true(surface->texture.cell_m == 0.2 && surface->texture.other.g == 0.5);
    assert_true(neph_is_textured(surface) && !neph_is_mirror(surface));
    neph_scene_destroy(scene);

    scene = loaded("sphere", ", metalness: 1");
    assert_true(neph_is_mirror(&scene->solids[0].surface));
    assert_true(neph_metal_obstacle(scene) && strstr(neph_surfaces_obstacle(scene), "metal"));
    neph_scene_destroy(scene);

    scene = loaded("box", ", texture: {pattern: checker, cell_m: 1, albedo: [0, 0, 0]}");
    assert_true(!neph_metal_obstacle(scene) && strstr(neph_surfaces_obstacle(scene), "texture"));
    neph_scene_destroy(scene);

    scene = loaded("box", "");
    assert_null(neph_surfaces_obstacle(scene));
    neph_scene_destroy(scene);
}

/* A plain solid has the hash from before surfaces existed, recorded then. */
static void test_hashes(void **state)
{
    struct neph_scene *plain = loaded("box", "");
    assert_string_equal(plain->hash,
                        "8de9fbb1bb88255579049bc4d252d4391f4d67b5ffecdd698e8461cbe35c82ec");
    struct neph_scene *same = loaded("box", ", metalness: 0");
    assert_string_equal(same->hash, plain->hash);
    neph_scene_destroy(same);
    neph_scene_destroy(plain);
}

static void test_what_cannot_be_is_refused(void **state)
{
    static const struct {
        const char *scattering, *solid, *keys, *message;
    } cases[] = {
        {"multiple", "box", ", metalness: 1.5", "1.5"},
        {"multiple", "box", ", metalness: 1, roughness: -0.1", "-0.1"},
        {"multiple", "box", ", metalness: 1, roughness: 0.01", "0 is a mirror"},
        {"multiple", "box", ", roughness: 0.5", "no metal"},
        {"multiple", "sphere", ", roughness: 0.5", "no metal"},
        {"single", "box", ", metalness: 1", "scattering: multiple"},
        {"none", "sphere", ", metalness: 1", "scattering: multiple"},
        {"multiple", "sphere", ", texture: {pattern: checker, cell_m: 1, albedo: [0, 0, 0]}",
         "texture"},
        {"multiple", "box", ", texture: {pattern: wood, cell_m: 1, albedo: [0, 0, 0]}", "noise"},
        {"multiple", "box", ", texture: {pattern: checker, cell_m: 0, albedo: [0, 0, 0]}", "0.001"},
        {"multiple", "box", ", texture: {pattern: checker, cell_m: 1}", "albedo"},
        {"multiple", "box", ", texture: {cell_m: 1, albedo: [0, 0, 0]}", "pattern"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_scene *scene = NULL;
        struct neph_diag diag = {.line = 0};
        assert_int_equal(load(cases[i].scattering, cases[i].solid, cases[i].keys, &scene, &diag),
                         NEPH_ERR_INPUT);
        assert_true(diag.line == 7);
        if (!strstr(diag.message, cases[i].message) && !strstr(diag.hint, cases[i].message))
            fail_msg("case %zu: %s (%s)", i, diag.message, diag.hint);
    }
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Grids of water and of effective radii: the extinction of each voxel, from an OpenVDB file, and
 * the errors of files and keys.
 */
#include "tests/base/scratch.h"

#include "base/child.h"
#include "base/text.h"
#include "scenes/grid.h"
#include "scenes/load_volume.h"
#include "scenes/media.h"

static int samples_setup(void **state)
{
    if (scratch_setup(state) != 0)
        return -1;
    const struct scratch *scratch = *state;
    const char *const argv[] = {NEPH_MAKE_VDB, scratch->folder, NULL};
    const struct neph_child_params params = {.argv = argv};
    struct neph_child_result result;
    return neph_child_run(&params, &result, NULL) == NEPH_OK ? 0 : -1;
}

static enum neph_status load(void **state, const char *keys, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    char *text = neph_format(
        "title: a probe\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\nmedia:\n  - volume: {file: droplets.vdb, %s, albedo: [1, 1, 1]}\n",
        keys);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    free(text);
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

/* Value i + 10 j + 100 k of water in droplets of 5 + i um; 2^-23 for each of two roundings. */
static void check_extinctions(const struct neph_medium *medium, enum neph_density_unit unit,
                              double factor, double variance)
{
    const struct neph_grid *grid = medium->grid;
    int count = 0;
    assert_int_equal(grid->size[0] * grid->size[1] * grid->size[2], 5 * 4 * 3);
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 5; i++, count++) {
                const struct neph_droplet_radii radii = {5.0 + i, variance};
                const double expected = neph_density_to_extinction_per_m(
                    unit, factor * (i + 10.0 * j + 100.0 * k), radii, NAN);
                neph_assert_close((double)grid->values[count] * medium->extinction_per_m, expected,
                                  0x1p-22, 0.0);
            }
}

static void test_each_voxel_has_its_radius(void **state)
{
    static const struct {
        const char *keys;
        enum neph_density_unit unit;
        double factor, variance;
    } cases[] = {
        {"grid: water, radius_grid: radius, water_g_per_m3: 1", NEPH_DENSITY_WATER, 1.0, 0.1},
        {"grid: water, radius_grid: radius, water_g_per_m3: 0.5, effective_variance: 0.2",
         NEPH_DENSITY_WATER, 0.5, 0.2},
        {"grid: water, radius_grid: radius, droplets_per_cm3: 1, radius_unit_um: 1",
         NEPH_DENSITY_DROPLETS, 1.0, 0.1},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene;
        struct neph_diag diag = {0};
        neph_assert_ok(load(state, cases[i].keys, &scene, &diag), &diag);
        check_extinctions(&scene->media[0], cases[i].unit, cases[i].factor, cases[i].variance);
        neph_scene_destroy(scene);
    }
}

static void test_errors(void **state)
{
    static const struct {
        const char *keys, *words, *hint;
    } cases[] = {
        {"grid: water, radius_grid: none, water_g_per_m3: 1", "it has no grid 'none'", ""},
        {"grid: water, radius_grid: radius_moved, water_g_per_m3: 1",
         "'radius_moved' has another transform", "resample"},
        {"grid: water, radius_grid: radius_short, water_g_per_m3: 1",
         "voxel (4, 3, 2) has 234 g/m3 and an effective radius of 0 um", "1e6 for metres"},
        {"grid: water, radius_grid: radius, water_g_per_m3: 1, radius_unit_um: 1e6",
         "an effective radius of 6e+06 um; 2 to 1000 um", "radius_unit_um"},
        {"grid: water, radius_grid: radius, extinction_per_m: 1", "volume.radius_grid: the values",
         "water_g_per_m3 or droplets_per_cm3"},
        {"grid: water, radius_grid: radius, water_g_per_m3: 1, effective_radius_um: 5",
         "volume.effective_radius_um: radius_grid is given, too", "leave one"},
        {"grid: water, radius_unit_um: 1, water_g_per_m3: 1, effective_radius_um: 5",
         "volume.radius_unit_um: it needs the key radius_grid", ""},
        {"grid: water, radius_grid: radius, water_g_per_m3: 1, optical_depth: 1",
         "volume.optical_depth: water_g_per_m3 is given, too", "leave one"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_scene *scene;
        struct neph_diag diag = {0};
        assert_int_equal(load(state, cases[i].keys, &scene, &diag), NEPH_ERR_INPUT);
        if (!strstr(diag.message, cases[i].words) || !strstr(diag.hint, cases[i].hint) ||
            diag.line != 5)
            fail_msg("%s: line %d: %s; %s", cases[i].keys, diag.line, diag.message, diag.hint);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_each_voxel_has_its_radius, samples_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_errors, samples_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: MIT
 *
 * Grids of water and of effective radii: the extinction of each voxel, from an OpenVDB file, and
 * the errors of files and keys.
 */
#include "tests/base/scratch.h"

#include "base/child.h"
#include "base/text.h"
#include "scenes/droplet_voxels.h"
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

static void test_weights_by_hand(void **state)
{
    static const struct {
        struct neph_radius_band band;
        double radius_um, weight;
    } cases[] = {
        {{5, 10, 20}, 4, 0.0},   {{5, 10, 20}, 5, 0.0},     {{5, 10, 20}, 7.5, 0.5},
        {{5, 10, 20}, 10, 1.0},  {{5, 10, 20}, 12.5, 0.75}, {{5, 10, 20}, 20, 0.0},
        {{5, 10, 20}, 900, 0.0}, {{10, 10, 20}, 2, 1.0},    {{10, 10, 20}, 10, 1.0},
        {{10, 10, 20}, 15, 0.5}, {{5, 10, 10}, 10, 1.0},    {{5, 10, 10}, 900, 1.0},
        {{5, 10, 10}, 6, 0.2},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        neph_assert_close(neph_radius_band_weight(&cases[i].band, cases[i].radius_um),
                          cases[i].weight, 0.0, 1e-15);
    /* Bands from peak to peak have all of each radius. */
    static const double peaks_um[] = {4.0, 5.5, 9.0, 17.0, 33.0};
    enum { PEAKS = COUNT(peaks_um) };
    for (double radius_um = 2.0; radius_um < 50.0; radius_um += 0.37) {
        double sum = 0.0;
        for (int b = 0; b < PEAKS; b++) {
            const struct neph_radius_band band = {peaks_um[b > 0 ? b - 1 : 0], peaks_um[b],
                                                  peaks_um[b < PEAKS - 1 ? b + 1 : b]};
            sum += neph_radius_band_weight(&band, radius_um);
        }
        neph_assert_close(sum, 1.0, 0.0, 1e-15);
    }
}

/* Voxels of 5 to 9 um in bands with peaks of 5, 6.5 and 8.5 um: in each voxel they have what the
 * medium without bands has, but for a rounding of each in float. */
static void test_bands_sum_to_the_whole(void **state)
{
    static const char *const bands[] = {"[5, 5, 6.5]", "[5, 6.5, 8.5]", "[6.5, 8.5, 8.5]"};
    static const char keys[] = "grid: water, radius_grid: radius, water_g_per_m3: 1";
    struct neph_scene *whole, *parts[COUNT(bands)];
    struct neph_diag diag = {0};
    neph_assert_ok(load(state, keys, &whole, &diag), &diag);
    for (size_t b = 0; b < COUNT(bands); b++) {
        char *with_band = neph_format("%s, radius_band_um: %s", keys, bands[b]);
        neph_assert_ok(load(state, with_band, &parts[b], &diag), &diag);
        assert_non_null(strstr(parts[b]->media[0].grid->note, "radius band"));
        free(with_band);
    }
    for (int node = 0; node < 5 * 4 * 3; node++) {
        double sum = 0.0;
        for (size_t b = 0; b < COUNT(bands); b++)
            sum += (double)parts[b]->media[0].grid->values[node];
        neph_assert_close(sum, (double)whole->media[0].grid->values[node], 0x1p-22, 0.0);
    }
    /* Index 1 along x: 6 um. */
    neph_assert_close((double)parts[1]->media[0].grid->values[1],
                      (double)whole->media[0].grid->values[1] * 2.0 / 3.0, 0x1p-22, 0.0);
    for (size_t b = 0; b < COUNT(bands); b++) {
        assert_string_not_equal(parts[b]->hash, whole->hash);
        assert_string_not_equal(parts[b]->hash, parts[(b + 1) % COUNT(bands)]->hash);
    }
    for (size_t b = 0; b < COUNT(bands); b++)
        neph_scene_destroy(parts[b]);
    neph_scene_destroy(whole);
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
        {"grid: water, radius_band_um: [5, 6, 7], water_g_per_m3: 1, effective_radius_um: 5",
         "volume.radius_band_um: it needs the key radius_grid", ""},
        {"grid: water, radius_grid: radius, radius_band_um: [5, 7, 6], water_g_per_m3: 1",
         "volume.radius_band_um: 5, 7, 6 um do not ascend", "two may be equal"},
        {"grid: water, radius_grid: radius, radius_band_um: [5, 6, 2000], water_g_per_m3: 1",
         "volume.radius_band_um", ""},
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
        cmocka_unit_test(test_weights_by_hand),
        cmocka_unit_test_setup_teardown(test_bands_sum_to_the_whole, samples_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_errors, samples_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

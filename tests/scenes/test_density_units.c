/* SPDX-License-Identifier: MIT
 *
 * Units of density against published values and closed forms, and as keys of scene files: a scene
 * has the hash of the same scene with extinction_per_m, and contradictions are refused.
 */
#include "tests/base/scratch.h"

#include "base/text.h"
#include "scenes/column.h"
#include "scenes/density_units.h"
#include "scenes/media.h"

#include <float.h>

static const struct neph_droplet_radii radii = {10.0, 0.1};

static double to_extinction(enum neph_density_unit unit, double value)
{
    return neph_density_to_extinction_per_m(unit, value, radii, 250.0);
}

/* ---- conversions ----------------------------------------------------------------------------- */

/* The constants of Koschmieder's law as they are printed, to their four digits. */
static void test_visibility(void **state)
{
    neph_assert_close(to_extinction(NEPH_DENSITY_VISIBILITY_2, 100.0), 3.912e-2, 1e-4, 0.0);
    neph_assert_close(to_extinction(NEPH_DENSITY_VISIBILITY_5, 100.0), 2.996e-2, 1e-4, 0.0);
}

/* Q -> 2 in geometric optics, so 1 g/m3 of droplets of 1 mm has 1.5 / (density r_e): the edge term
 * adds 0.2 %. Deirmendjian's cloud C.1 (r_e 6 um, v 1/9) has 100 droplets per cm3, 0.063 g/m3 and
 * 16.33 /km at 700 nm (Deirmendjian 1969), where Q is 2 % larger than at 550 nm. */
static void test_water(void **state)
{
    const struct neph_droplet_radii large = {1000.0, 0.1}, c1 = {6.0, 1.0 / 9.0};
    const double per_m = neph_density_to_extinction_per_m(NEPH_DENSITY_WATER, 1.0, large, NAN);
    neph_assert_close(per_m, 1.5 / (998.2e3 * 1e-3), 3e-3, 0.0);
    const double of_c1 = neph_density_to_extinction_per_m(NEPH_DENSITY_DROPLETS, 100.0, c1, NAN);
    neph_assert_close(of_c1, 16.33e-3, 0.03, 0.0);
    neph_assert_close(neph_density_from_extinction(NEPH_DENSITY_WATER, of_c1, c1, NAN), 0.0627,
                      0.005, 0.0);
}

/* sigma = 3 Q W / (4 rho r_e), and W / N is the mean mass of a droplet, 4/3 pi rho r_e^3 (1 - v) (1
 * - 2 v). */
static void test_droplets_of_water(void **state)
{
    const double q = neph_droplet_extinction_efficiency(radii);
    neph_assert_close(to_extinction(NEPH_DENSITY_WATER, 0.3),
                      3.0 * q * 0.3e-3 / (4.0 * 998.2 * 10e-6), 1e-14, 0.0);
    const double grams = 1e3 * 4.0 / 3.0 * M_PI * 998.2 * 1e-15 * 0.9 * 0.8;
    const double water = neph_density_from_extinction(
        NEPH_DENSITY_WATER, to_extinction(NEPH_DENSITY_DROPLETS, 50.0), radii, NAN);
    neph_assert_close(water, 50e6 * grams, 1e-13, 0.0);
}

static void test_every_unit_has_an_inverse(void **state)
{
    for (int unit = 0; unit < NEPH_DENSITY_UNIT_COUNT; unit++) {
        const double back = neph_density_from_extinction(unit, to_extinction(unit, 0.7), radii,
                                                         250.0);
        neph_assert_close(back, 0.7, 4.0 * DBL_EPSILON, 0.0);
    }
    assert_true(isinf(neph_density_from_extinction(NEPH_DENSITY_VISIBILITY_2, 0.0, radii, 1.0)));
    assert_true(neph_density_from_extinction(NEPH_DENSITY_OPTICAL_DEPTH, 0.0, radii, INFINITY) ==
                0.0);
}

static void test_assumed_radii(void **state)
{
    const struct neph_droplet_radii none = {0.0, 0.0}, one = {5.0, 0.0};
    assert_float_equal(neph_droplet_radii_assume(none).effective_radius_um, 10.0, 0);
    assert_float_equal(neph_droplet_radii_assume(one).effective_radius_um, 5.0, 0);
    assert_float_equal(neph_droplet_radii_assume(one).effective_variance, 0.1, 0);
}

/* ---- scenes ---------------------------------------------------------------------------------- */

#define BOX "bounds: {min_m: [-10, 5, -20], max_m: [10, 30, 20]}"

static enum neph_status load(void **state, const char *medium, struct neph_scene **scene,
                             struct neph_diag *diag)
{
    char path[SCRATCH_PATH_MAX];
    char *text = neph_format(
        "title: a probe\n"
        "camera: {position_m: [0, 1, 50], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"
        "scattering: none\nmedia:\n  - %s\n",
        medium);
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    free(text);
    *scene = NULL;
    return neph_scene_load(path, scene, diag);
}

static struct neph_scene *load_good(void **state, const char *medium)
{
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    const enum neph_status status = load(state, medium, &scene, &diag);
    if (status)
        print_error("%s\n", medium);
    neph_assert_ok(status, &diag);
    return scene;
}

/* A medium in which %s is a density, the optical depth along a direction for 1/m, and that
 * direction. */
static const struct shape {
    const char *text, *along;
    double column_m;
} shapes[] = {
    {"homogeneous: {%s, " BOX ", albedo: [1, 1, 1]}", "y", 25.0},
    {"homogeneous: {%s, " BOX ", albedo: [1, 1, 1]}", "z", 40.0},
    {"gaussian: {%s, center_m: [1, 2, 3], width_m: 2, albedo: [1, 1, 1]}", "x",
     2.0 * 2.50662827463100050},
    {"plume: {%s, foot_m: [1, 2, 3], axis: [0, 2, 0], width_m: 2, scale_height_m: 5, "
     "albedo: [1, 1, 1]}",
     "y", 5.0},
    {"tent: {%s, center_m: [0, -6e6, 0], radius_m: 6e6, altitude_m: 2e4, half_width_m: 1e4, "
     "albedo: [1, 1, 1]}",
     "y", 1e4},
    {"shell: {%s, center_m: [0, -6e6, 0], radius_m: 6e6, scale_height_m: 1000, albedo: [1, 1, 1], "
     "bounds: {min_m: [-7e6, -13e6, -7e6], max_m: [7e6, 1e6, 7e6]}}",
     "y", 1000.0},
    {"height_fog: {layers: [{%s, falloff_per_m: 0.1, height_m: 3}], albedo: [1, 1, 1]}", "y", 10.0},
    /* From the bottom of the bounds, 5 m, to their top. */
    {"height_fog: {layers: [{extinction_per_m: 3, falloff_per_m: 0.1, height_m: 3}, {%s, "
     "falloff_per_m: 0.1, height_m: 5}], " BOX ", albedo: [1, 1, 1]}",
     "y", 10.0 * 0.917915001376101},
    /* The level line at the bottom of the bounds. */
    {"height_fog: {layers: [{%s, falloff_per_m: 0.1, height_m: 5}], " BOX ", albedo: [1, 1, 1]}",
     "x", 20.0},
    /* Columns of 1 + 3 + 5 and 2 + 4 + 6 nodes; rows; the last plane within bounds. */
    {"grid: {%s, size: [2, 1, 3], origin_m: [0, 0, 0], spacing_m: [1, 1, 2], values: [1, 2, 3, 4, "
     "5, 6], albedo: [1, 1, 1]}",
     "z", 24.0},
    {"grid: {%s, size: [2, 1, 3], origin_m: [0, 0, 0], spacing_m: [1, 1, 2], values: [1, 2, 3, 4, "
     "5, 6], albedo: [1, 1, 1]}",
     "x", 11.0},
    {"grid: {%s, size: [2, 1, 3], origin_m: [0, 0, 0], spacing_m: [1, 1, 2], values: [1, 2, 3, 4, "
     "5, 6], bounds: {min_m: [-9, -9, -9], max_m: [9, 9, 3]}, albedo: [1, 1, 1]}",
     "y", 4.0},
};

/* The other units by their keys, and the extinction of each. */
static const struct {
    const char *keys;
    enum neph_density_unit unit;
    double value;
} units[] = {
    {"water_g_per_m3: 0.3, effective_radius_um: 10, effective_variance: 0.1", NEPH_DENSITY_WATER,
     0.3},
    {"droplets_per_cm3: 60, effective_radius_um: 10", NEPH_DENSITY_DROPLETS, 60.0},
    {"visibility_2_percent_m: 70", NEPH_DENSITY_VISIBILITY_2, 70.0},
    {"visibility_5_percent_m: 70", NEPH_DENSITY_VISIBILITY_5, 70.0},
};

static struct neph_scene *load_shape(void **state, const struct shape *shape, const char *density)
{
    const char *at = strstr(shape->text, "%s");
    char *text = neph_format("%.*s%s%s", (int)(at - shape->text), shape->text, density, at + 2);
    struct neph_scene *scene = load_good(state, text);
    free(text);
    return scene;
}

static void test_a_unit_is_the_same_scene(void **state)
{
    for (size_t s = 0; s < COUNT(shapes); s++)
        for (size_t u = 0; u < COUNT(units); u++) {
            char density[64];
            snprintf(density, sizeof(density), "extinction_per_m: %.17g",
                     to_extinction(units[u].unit, units[u].value));
            struct neph_scene *scene = load_shape(state, &shapes[s], units[u].keys),
                              *same = load_shape(state, &shapes[s], density);
            assert_string_equal(scene->hash, same->hash);
            neph_scene_destroy(scene);
            neph_scene_destroy(same);
        }
}

static double get_extinction(const struct neph_medium *medium)
{
    return medium->layer_count ? medium->layers[medium->layer_count - 1].extinction_per_m
                               : medium->extinction_per_m;
}

/* 1e-9 for the shell and the tent: the rounding of a metre at the radius of a planet, over their
 * height. */
static void test_optical_depth(void **state)
{
    for (size_t s = 0; s < COUNT(shapes); s++) {
        char keys[64];
        snprintf(keys, sizeof(keys), "optical_depth: 6, optical_depth_along: %s", shapes[s].along);
        struct neph_scene *scene = load_shape(state, &shapes[s], keys);
        const bool is_planet = strstr(shapes[s].text, "6e6");
        neph_assert_close(get_extinction(&scene->media[0]), 6.0 / shapes[s].column_m,
                          is_planet ? 1e-9 : 1e-12, 0.0);
        neph_scene_destroy(scene);
    }
}

/* The optical depth of a medium without an end, or that is not computed. */
static void test_no_optical_depth(void **state)
{
    struct neph_scene *scene = load_good(
        state,
        "grid: {extinction_per_m: 1, size: [1, 1, 1], origin_m: [0, 0, 0], spacing_m: [1, 1, "
        "1], values: [1], repeat: [0, 1, 1], albedo: [1, 1, 1]}");
    assert_true(isinf(neph_medium_column_optical_depth(&scene->media[0], 0)));
    neph_assert_close(neph_medium_column_optical_depth(&scene->media[0], 1), 1.0, 1e-14, 0.0);
    neph_scene_destroy(scene);
}

static void test_refusals(void **state)
{
    static const struct {
        const char *medium, *place, *words;
    } refusals[] = {
        {"homogeneous: {water_g_per_m3: 1, extinction_per_m: 1, effective_radius_um: 10, " BOX
         ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.water_g_per_m3", "extinction_per_m is given, too"},
        {"homogeneous: {visibility_2_percent_m: 1, visibility_5_percent_m: 1, " BOX
         ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.visibility_5_percent_m", "visibility_2_percent_m is given, too"},
        {"homogeneous: {" BOX ", albedo: [1, 1, 1]}", "media[0].homogeneous",
         "missing key: a medium has exactly one of extinction_per_m, water_g_per_m3"},
        {"homogeneous: {water_g_per_m3: 1, " BOX ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.water_g_per_m3", "needs the key effective_radius_um"},
        {"homogeneous: {extinction_per_m: 1, effective_variance: 0.1, " BOX ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.effective_variance", "needs the key effective_radius_um"},
        {"homogeneous: {extinction_per_m: 1, optical_depth_along: x, " BOX ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.optical_depth_along", "needs the key optical_depth"},
        {"homogeneous: {water_g_per_m3: 1, effective_radius_um: 1, " BOX ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.effective_radius_um", "1 is outside 2 to 1000 um"},
        {"homogeneous: {water_g_per_m3: 1e5, effective_radius_um: 2, " BOX ", albedo: [1, 1, 1]}",
         "media[0].homogeneous.water_g_per_m3", "outside 0 to 10000 /m"},
        {"height_fog: {layers: [{falloff_per_m: 1, height_m: 0}], albedo: [1, 1, 1]}",
         "media[0].height_fog.layers[0]", "missing key: a medium has exactly one of"},
        {"height_fog: {layers: [{optical_depth: 1, optical_depth_along: x, falloff_per_m: 1, "
         "height_m: 0}], albedo: [1, 1, 1]}",
         "media[0].height_fog.layers[0].optical_depth", "infinite along x for any extinction"},
        {"gaussian: {optical_depth: 1, center_m: [1, 2, 3], width_m: 2, " BOX
         ", albedo: [1, 1, 1]}",
         NULL, NULL}, /* its centre is below the bounds, but the vertical line meets them */
        {"gaussian: {optical_depth: 1, optical_depth_along: x, center_m: [1, 2, 3], width_m: "
         "2, " BOX ", albedo: [1, 1, 1]}",
         "media[0].gaussian.optical_depth", "the line along x through the densest place has no"},
        {"horizon: {optical_depth: 1, albedo: [1, 1, 1], bounds: {min_m: [-9, 80, -9], max_m: [9, "
         "360, 9]}}",
         "media[0].horizon.optical_depth", "has no densest column"},
    };
    for (size_t i = 0; i < COUNT(refusals); i++) {
        struct neph_scene *scene;
        struct neph_diag diag = {0};
        const enum neph_status status = load(state, refusals[i].medium, &scene, &diag);
        neph_scene_destroy(scene);
        if (!refusals[i].words) {
            neph_assert_ok(status, &diag);
            continue;
        }
        assert_int_equal(status, NEPH_ERR_INPUT);
        char start[128];
        snprintf(start, sizeof(start), "%s: ", refusals[i].place);
        if (strncmp(diag.message, start, strlen(start)) != 0 ||
            !strstr(diag.message, refusals[i].words))
            fail_msg("%s: %s", refusals[i].words, diag.message);
        assert_int_equal(diag.line, 5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_visibility),
        cmocka_unit_test(test_water),
        cmocka_unit_test(test_droplets_of_water),
        cmocka_unit_test(test_every_unit_has_an_inverse),
        cmocka_unit_test(test_assumed_radii),
        scratch_test(test_a_unit_is_the_same_scene),
        scratch_test(test_optical_depth),
        scratch_test(test_no_optical_depth),
        scratch_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

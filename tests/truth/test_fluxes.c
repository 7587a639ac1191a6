/* SPDX-License-Identifier: MIT
 *
 * Fluxes of columns: against adding-doubling, against the step cloud's own Monte Carlo, and by
 * conservation.
 */
#include "tests/scene_builders.h"

#include "base/doubt.h"
#include "base/threads.h"
#include "truth/fluxes.h"
#include "truth/slab.h"
#include "truth/step_cloud.h"

static const double thickness_m = 100.0;

/* Sunlight towards +x, a homogeneous slab without end. */
static struct neph_scene make_slab(double depth, double albedo, double g, double sun_cosine)
{
    struct neph_bounds bounds = everywhere;
    bounds.min_m.y = 0.0;
    bounds.max_m.y = thickness_m;
    struct neph_scene scene = {.name = "slab", .scattering = NEPH_SCATTERING_MULTIPLE};
    scene.sun.present = true;
    scene.sun.direction = (struct neph_vec3){-sqrt(1.0 - sun_cosine * sun_cosine), sun_cosine, 0};
    scene.sun.irradiance_w_per_m2 = make_grey(3.0);
    scene.media[0] = make_homogeneous(depth / thickness_m, bounds);
    scene.media[0].albedo = make_grey(albedo);
    scene.media[0].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, g};
    scene.medium_count = 1;
    return scene;
}

static struct neph_solid make_ground(struct neph_rgb albedo)
{
    return (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = {{-1e6, -1, -1e6}, {1e6, 0, 1e6}}, .albedo = albedo};
}

static struct neph_fluxes_params make_params(int columns_x, int columns_z, int paths)
{
    return (struct neph_fluxes_params){.columns_x = columns_x,
                                       .columns_z = columns_z,
                                       .bottom_m = NAN,
                                       .top_m = NAN,
                                       .paths = paths,
                                       .seed = 7};
}

static struct neph_fluxes trace(const struct neph_scene *scene,
                                const struct neph_fluxes_params *params)
{
    struct neph_fluxes fluxes = {.sums = NULL};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_fluxes_trace(scene, params, &fluxes, &diag), &diag);
    return fluxes;
}

/* Within four standard errors: exceeded once in 16000 by chance; the seed is fixed. */
static void assert_flux(struct neph_flux_estimate found, double expected)
{
    /* The bottom level is 1e-9 of the height above a ground: 3e-8 of an optical depth of 27. */
    neph_assert_close(found.mean, expected, 0.0, 4.0 * found.standard_error + 3e-8);
}

/* All fluxes and both radiances; a standard error of 1 % at most, so that the test can fail. */
static void test_homogeneous_columns_against_the_slab(void **state)
{
    static const struct {
        double depth, albedo, g, sun_cosine;
    } cases[] = {{4.0, 1.0, 0.85, 0.5}, {1.0, 0.9, 0.0, 1.0}, {8.0, 0.99, 0.7, 0.3}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_scene scene = make_slab(cases[i].depth, cases[i].albedo, cases[i].g,
                                                  cases[i].sun_cosine);
        const double up = 1.0, per_sun = M_PI / cases[i].sun_cosine;
        struct neph_slab *slab = NULL;
        struct neph_diag diag = {0};
        neph_assert_ok(
            neph_slab_create(&(struct neph_slab_params){.optical_depth = cases[i].depth,
                                                        .albedo = cases[i].albedo,
                                                        .phase = scene.media[0].phase,
                                                        .sun_cosine = cases[i].sun_cosine,
                                                        .view_count = 1,
                                                        .view_cosines = &up},
                             &slab, &diag),
            &diag);
        const struct neph_slab_fluxes truth = neph_slab_fluxes(slab);
        const struct neph_fluxes_params params = make_params(1, 1, neph_test_paths(200000));
        struct neph_fluxes fluxes = trace(&scene, &params);
        const double expected[NEPH_FLUX_COUNT] = {
            [NEPH_FLUX_REFLECTED] = truth.reflected,
            [NEPH_FLUX_TRANSMITTED] = truth.transmitted + truth.direct,
            [NEPH_FLUX_DIRECT] = truth.direct,
            [NEPH_FLUX_ABSORBED] = 1.0 - truth.reflected - truth.transmitted - truth.direct,
            [NEPH_FLUX_NADIR] = per_sun * neph_slab_reflected_per_sr(slab, 0, 0.0),
            [NEPH_FLUX_ZENITH] = per_sun * neph_slab_transmitted_per_sr(slab, 0, 0.0)};
        for (int flux = 0; flux < NEPH_FLUX_COUNT; flux++) {
            const struct neph_flux_estimate found = neph_flux_of_domain(&fluxes,
                                                                        (enum neph_flux)flux, 0);
            assert_flux(found, expected[flux]);
            assert_true(found.standard_error <= neph_test_noise(0.02));
        }
        assert_true(fluxes.channel_count == 1);
        neph_fluxes_finish(&fluxes);
        neph_slab_destroy(slab);
    }
}

enum { STEPS = 32 };

/* Case 1 of I3RC with constant cells. */
static void test_columns_against_the_step_cloud(void **state)
{
    double depths[STEPS];
    struct neph_estimate nadir_per_sr[STEPS];
    struct neph_step_cloud_fluxes truth;
    struct neph_diag diag = {0};
    struct neph_grid *grid = NULL;
    struct neph_scene scene = make_slab(1.0, 0.99, 0.85, 0.5);
    neph_assert_ok(neph_grid_create((const int[3]){STEPS, 1, 1}, (struct neph_vec3){0, 50, 0},
                                    (struct neph_vec3){15.625, thickness_m, 15.625}, &grid, &diag),
                   &diag);
    for (int i = 0; i < STEPS; i++) {
        depths[i] = i < STEPS / 2 ? 2.0 : 18.0;
        grid->values[i] = (float)(depths[i] / thickness_m);
    }
    grid->is_constant = grid->is_endless[0] = grid->is_endless[2] = true;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    const struct neph_medium even = scene.media[0];
    scene.media[0] = make_voxels(1.0, grid);
    scene.media[0].albedo = even.albedo;
    scene.media[0].phase = even.phase;
    neph_assert_ok(
        neph_step_cloud_solve(&(struct neph_step_cloud_params){.column_count = STEPS,
                                                               .optical_depths = depths,
                                                               .column_width_m = 15.625,
                                                               .thickness_m = thickness_m,
                                                               .albedo = 0.99,
                                                               .phase = even.phase,
                                                               .sun_cosine = 0.5,
                                                               .seed = 1,
                                                               .photons = neph_test_paths(200000)},
                              &truth, nadir_per_sr, &diag),
        &diag);
    const struct neph_fluxes_params params = make_params(STEPS, 1, neph_test_paths(12000));
    struct neph_fluxes fluxes = trace(&scene, &params);
    const struct neph_estimate expected[] = {
        [NEPH_FLUX_REFLECTED] = truth.reflected, [NEPH_FLUX_TRANSMITTED] = truth.transmitted,
        [NEPH_FLUX_DIRECT] = {NAN, NAN},         [NEPH_FLUX_UPWARD] = {0.0, 0.0},
        [NEPH_FLUX_ABSORBED] = truth.absorbed,
    };
    for (size_t flux = 0; flux < COUNT(expected); flux++) {
        const struct neph_flux_estimate found = neph_flux_of_domain(&fluxes, (enum neph_flux)flux,
                                                                    0);
        if (!isnan(expected[flux].mean))
            neph_assert_close(found.mean, expected[flux].mean, 0.0,
                              4.0 * hypot(found.standard_error, expected[flux].standard_error));
    }
    for (int half = 0; half < 2; half++) {
        const double scale = M_PI / 0.5; /* pi over the cosine of the sun */
        double off = 0.0, variance = 0.0;
        for (int i = half * STEPS / 2; i < (half + 1) * STEPS / 2; i++) {
            const struct neph_flux_estimate nadir = neph_flux_of_column(&fluxes, NEPH_FLUX_NADIR, i,
                                                                        0);
            off += nadir.mean - scale * nadir_per_sr[i].mean;
            variance += nadir.standard_error * nadir.standard_error +
                        scale * scale * nadir_per_sr[i].standard_error *
                            nadir_per_sr[i].standard_error;
        }
        print_message("nadir radiance off by %.2f standard errors\n", off / sqrt(variance));
        assert_true(fabs(off) < 4.0 * sqrt(variance));
    }
    neph_fluxes_finish(&fluxes);
    neph_grid_destroy(grid);
}

/* Colour, and a ground: the light of the ground is its albedo of what arrives there, and the parts
 * add up to 1 in each channel. */
static void test_ground_and_colour_conserve_light(void **state)
{
    const struct neph_rgb albedo = {0.4, 0.8, 0.1};
    struct neph_scene scene = make_slab(3.0, 1.0, 0.6, 0.7);
    struct neph_solid ground = make_ground(albedo);
    scene.media[0].albedo = (struct neph_rgb){1.0, 0.9, 0.5};
    scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.5, 1.5};
    scene.solids = &ground;
    scene.solid_count = 1;
    /* So wide that a reflected photon starts above the bottom level, by rounding. */
    scene.media[0].bounds.min_m.x = -1e6;
    scene.media[0].bounds.max_m.x = 1e6;
    const struct neph_fluxes_params params = make_params(2, 1, neph_test_paths(20000));
    struct neph_fluxes fluxes = trace(&scene, &params);
    const double part[3] = {albedo.r, albedo.g, albedo.b};
    assert_int_equal(fluxes.channel_count, 3);
    for (int c = 0; c < 3; c++) {
        const struct neph_flux_estimate down = neph_flux_of_domain(&fluxes, NEPH_FLUX_TRANSMITTED,
                                                                   c),
                                        up = neph_flux_of_domain(&fluxes, NEPH_FLUX_UPWARD, c);
        neph_assert_close(up.mean, part[c] * down.mean, 0.0,
                          4.0 * hypot(up.standard_error, part[c] * down.standard_error));
        assert_flux(neph_flux_of_domain(&fluxes, NEPH_FLUX_HORIZONTAL, c), 0.0);
    }
    /* Without colour in one channel only: the slab of that channel. */
    assert_true(neph_flux_of_domain(&fluxes, NEPH_FLUX_ABSORBED, 0).mean == 0.0);
    neph_fluxes_finish(&fluxes);
}

/* Sunlight also enters the sides of a cloud that ends, and light leaves them. */
static void test_open_sides(void **state)
{
    struct neph_scene scene = make_slab(1e-9, 1.0, 0.0, 0.5);
    scene.media[0].bounds = (struct neph_bounds){{0, 0, 0}, {100, thickness_m, 60}};
    struct neph_fluxes_params params = make_params(5, 3, 32);
    struct neph_fluxes fluxes = trace(&scene, &params);
    for (int column = 0; column < 15; column++)
        neph_assert_close(neph_flux_of_column(&fluxes, NEPH_FLUX_DIRECT, column, 0).mean, 1.0, 0.0,
                          0.5); /* photons start at random places, 32 above each column */
    neph_assert_close(neph_flux_of_domain(&fluxes, NEPH_FLUX_DIRECT, 0).mean, 1.0, 0.0, 0.1);
    neph_fluxes_finish(&fluxes);
    scene.media[0].layers[0].extinction_per_m = 0.05;
    params.paths = neph_test_paths(6000);
    fluxes = trace(&scene, &params);
    assert_true(neph_flux_of_domain(&fluxes, NEPH_FLUX_HORIZONTAL, 0).mean > 0.1);
    neph_fluxes_finish(&fluxes);
}

static void test_bits_do_not_depend_on_the_threads(void **state)
{
    const struct neph_scene scene = make_slab(4.0, 0.9, 0.85, 0.5);
    const struct neph_fluxes_params params = make_params(3, 2, 600);
    const size_t bytes = NEPH_FLUX_COUNT * 6 * sizeof(struct neph_moments);
    struct neph_fluxes runs[2];
    for (int run = 0; run < 2; run++) {
        neph_set_thread_count(run ? 5 : 1);
        runs[run] = trace(&scene, &params);
    }
    assert_memory_equal(runs[0].sums, runs[1].sums, bytes);
    struct neph_fluxes_params other = params;
    other.seed++;
    neph_fluxes_finish(&runs[1]);
    runs[1] = trace(&scene, &other);
    assert_memory_not_equal(runs[0].sums, runs[1].sums, bytes);
    neph_fluxes_finish(&runs[0]);
    neph_fluxes_finish(&runs[1]);
}

/* Light that is scattered by a degree: looking up beside the sun, few paths make the radiance. */
static void test_error_bars_of_rare_paths_are_doubted(void **state)
{
    struct neph_scene scene = make_slab(4.0, 1.0, 0.98, cos(0.3));
    struct neph_fluxes_params params = make_params(1, 1, 2048);
    struct neph_fluxes fluxes = trace(&scene, &params);
    const struct neph_flux_estimate zenith = neph_flux_of_domain(&fluxes, NEPH_FLUX_ZENITH, 0);
    print_message("zenith %g, doubt %.2g\n", zenith.mean, zenith.doubt);
    assert_true(zenith.doubt > NEPH_DOUBTFUL);
    assert_true(neph_flux_of_domain(&fluxes, NEPH_FLUX_TRANSMITTED, 0).doubt < NEPH_DOUBTFUL);
    assert_int_equal(neph_flux_doubtful_columns(&fluxes, NEPH_FLUX_ZENITH, 0), 1);
    neph_fluxes_finish(&fluxes);
}

static void assert_refused(const struct neph_scene *scene, const struct neph_fluxes_params *params,
                           enum neph_status status, const char *words)
{
    struct neph_fluxes fluxes = {.sums = NULL};
    struct neph_diag diag = {0};
    assert_int_equal(neph_fluxes_trace(scene, params, &fluxes, &diag), status);
    if (!strstr(diag.message, words))
        fail_msg("'%s' does not contain '%s'", diag.message, words);
    assert_null(fluxes.sums);
}

static void test_bad_scenes_are_refused(void **state)
{
    const struct neph_scene good = make_slab(1.0, 1.0, 0.0, 0.5);
    const struct neph_fluxes_params params = make_params(1, 1, 16);
    struct neph_solid tower = make_ground(white);
    tower.box = (struct neph_bounds){{0.3, -1, 0.3}, {0.6, 20, 0.6}};
    struct neph_scene bad = good;
    bad.sun.direction = (struct neph_vec3){1, 0, 0};
    assert_refused(&bad, &params, NEPH_ERR_INPUT, "no sun above the horizon");
    bad = good;
    bad.medium_count = 0;
    assert_refused(&bad, &params, NEPH_ERR_INPUT, "no medium");
    bad = good;
    bad.media[0].bounds = everywhere;
    assert_refused(&bad, &params, NEPH_ERR_INPUT, "without end along y");
    bad = good;
    bad.solids = &tower;
    bad.solid_count = 1;
    assert_refused(&bad, &params, NEPH_ERR_INPUT, "above the bottom level of 0 m");
    tower.box.min_m.x = tower.box.min_m.z = -1e6; /* a ground, not where the level is */
    tower.box.max_m.x = tower.box.max_m.z = 1e6;
    struct neph_fluxes_params low = params;
    low.bottom_m = 0.0;
    assert_refused(&bad, &low, NEPH_ERR_INPUT, "above the bottom level of 0 m");
    bad = good;
    bad.media[0].bounds.min_m.x = bad.media[0].bounds.min_m.z = 0.0;
    bad.media[0].bounds.max_m.x = bad.media[0].bounds.max_m.z = 1.0;
    bad.sun.direction = neph_vec3_normalize((struct neph_vec3){1, 1e-7, 0});
    assert_refused(&bad, &params, NEPH_ERR_INPUT, "degrees above the horizon");
    struct neph_fluxes_params wrong = params;
    wrong.columns_z = 0;
    assert_refused(&good, &wrong, NEPH_ERR_USAGE, "1 x 0 columns");
    wrong = params;
    wrong.paths = 15;
    assert_refused(&good, &wrong, NEPH_ERR_USAGE, "15 paths");
    wrong = params;
    wrong.top_m = 99.0;
    assert_refused(&good, &wrong, NEPH_ERR_INPUT, "between the levels");
}

#include "tests/main.h"

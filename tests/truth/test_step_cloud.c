/* SPDX-License-Identifier: MIT
 *
 * Repeated columns: the step cloud of I3RC, and cases with slabs as the truth.
 */
#include "tests/neph_test.h"

#include "truth/slab.h"
#include "truth/step_cloud.h"

/* Within four standard errors of the estimate and of the expected value: exceeded once in 16000 by
 * chance; the seed is fixed. */
static void assert_estimate(struct neph_estimate estimate, double expected, double expected_error)
{
    assert_true(estimate.standard_error >= 0.0);
    neph_assert_close(estimate.mean, expected, 0.0,
                      4.0 * hypot(estimate.standard_error, expected_error) + 1e-14);
}

/* Case 1 of the intercomparison: 16 columns of optical depth 2, 16 of 18, over 500 m, 250 m thick,
 * Henyey-Greenstein 0.85. Experiments 1..4: sun at 0 and 60 degrees with albedo 1, then with 0.99.
 * The caller sets seed and photons. */
static struct neph_step_cloud_params i3rc_case(int experiment, double optical_depths[32])
{
    for (int i = 0; i < 32; i++)
        optical_depths[i] = i < 16 ? 2.0 : 18.0;
    return (struct neph_step_cloud_params){.column_count = 32,
                                           .optical_depths = optical_depths,
                                           .column_width_m = 500.0 / 32.0,
                                           .thickness_m = 250.0,
                                           .albedo = experiment <= 2 ? 1.0 : 0.99,
                                           .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.85},
                                           .sun_cosine = experiment % 2 ? 1.0 : 0.5};
}

/* Domain means of another Monte Carlo, which agrees with the consensus of the intercomparison to
 * 0.06 %; four digits. */
static void test_i3rc_step_cloud(void **state)
{
    static const struct {
        double reflected, transmitted, absorbed;
    } expected[] = {{0.3277, 0.6723, 0.0},
                    {0.5808, 0.4192, 0.0},
                    {0.2609, 0.5981, 0.1410},
                    {0.4765, 0.3249, 0.1986}};
    for (int experiment = 1; experiment <= 4; experiment++) {
        double depths[32];
        struct neph_step_cloud_params params = i3rc_case(experiment, depths);
        params.seed = 20051;
        params.photons = neph_test_paths(200000);
        struct neph_step_cloud_fluxes fluxes;
        struct neph_diag diag = {.message = ""};
        neph_assert_ok(neph_step_cloud_solve(&params, &fluxes, NULL, &diag), &diag);
        print_message("experiment %d: R %.4f T %.4f A %.4f, standard errors %.4f %.4f %.4f\n",
                      experiment, fluxes.reflected.mean, fluxes.transmitted.mean,
                      fluxes.absorbed.mean, fluxes.reflected.standard_error,
                      fluxes.transmitted.standard_error, fluxes.absorbed.standard_error);
        const double noise = 2e-4; /* 0.06 % */
        assert_estimate(fluxes.reflected, expected[experiment - 1].reflected, noise);
        assert_estimate(fluxes.transmitted, expected[experiment - 1].transmitted, noise);
        assert_estimate(fluxes.absorbed, expected[experiment - 1].absorbed, noise);
        if (params.albedo == 1.0)
            neph_assert_close(fluxes.reflected.mean + fluxes.transmitted.mean, 1.0, 1e-12, 0.0);
    }
}

/* Equal columns are a slab, whatever their width: fluxes and nadir radiance by adding-doubling. */
static void test_equal_columns_are_a_slab(void **state)
{
    static const struct {
        double depth, albedo, sun_cosine, g, width_m;
    } cases[] = {
        {0.5, 1.0, 0.6, 0.0, 3.0}, {4.0, 0.95, 0.9, 0.7, 100.0}, {8.0, 0.5, 1.0, -0.3, 0.5}};
    static const double straight_up[] = {1.0};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const double depths[3] = {cases[i].depth, cases[i].depth, cases[i].depth};
        const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, cases[i].g};
        struct neph_step_cloud_fluxes fluxes;
        struct neph_estimate nadir[3];
        struct neph_slab *slab = NULL;
        struct neph_diag diag = {.message = ""};
        neph_assert_ok(neph_step_cloud_solve(
                           &(struct neph_step_cloud_params){
                               3, depths, cases[i].width_m, 10.0, cases[i].albedo, phase,
                               cases[i].sun_cosine, 7, neph_test_paths(100000)},
                           &fluxes, nadir, &diag),
                       &diag);
        neph_assert_ok(
            neph_slab_create(&(struct neph_slab_params){cases[i].depth, cases[i].albedo, phase,
                                                        cases[i].sun_cosine, 1, straight_up, 0},
                             &slab, &diag),
            &diag);
        const struct neph_slab_fluxes exact = neph_slab_fluxes(slab);
        assert_estimate(fluxes.reflected, exact.reflected, 0.0);
        assert_estimate(fluxes.transmitted, exact.transmitted + exact.direct, 0.0);
        assert_estimate(fluxes.absorbed, 1.0 - exact.reflected - exact.transmitted - exact.direct,
                        0.0);
        for (int c = 0; c < 3; c++)
            assert_estimate(nadir[c], neph_slab_reflected_per_sr(slab, 0, 0.0), 0.0);
        neph_slab_destroy(slab);
    }
}

/* Columns much wider than thick are nearly independent: the result is the mean of two slabs.
 * Columns much narrower than a free path are one slab of the mean depth. */
static void test_wide_and_narrow_columns(void **state)
{
    const double depths[2] = {0.5, 4.0};
    struct neph_step_cloud_params params = {
        2, depths, 1e6, 10.0, 1.0, {NEPH_PHASE_ISOTROPIC, 0.0}, 0.7, 11, neph_test_paths(100000)};
    struct neph_step_cloud_fluxes wide, narrow;
    double reflected[3];
    const double slabs[3] = {0.5, 4.0, 2.25};
    for (int i = 0; i < 3; i++) {
        struct neph_slab *slab = NULL;
        neph_assert_ok(neph_slab_create(
                           &(struct neph_slab_params){slabs[i], 1.0, params.phase, 0.7, 0, NULL, 0},
                           &slab, NULL),
                       NULL);
        reflected[i] = neph_slab_fluxes(slab).reflected;
        neph_slab_destroy(slab);
    }
    neph_assert_ok(neph_step_cloud_solve(&params, &wide, NULL, NULL), NULL);
    params.column_width_m = 1e-3;
    params.photons = neph_test_paths(3000);
    neph_assert_ok(neph_step_cloud_solve(&params, &narrow, NULL, NULL), NULL);
    /* The fraction of the columns within a few thicknesses of a side: 10 / 1e6. */
    assert_estimate(wide.reflected, 0.5 * (reflected[0] + reflected[1]), 1e-4);
    assert_estimate(narrow.reflected, reflected[2], 1e-3);
    assert_true(fabs(reflected[2] - 0.5 * (reflected[0] + reflected[1])) > 0.02);
}

static void test_same_seed_same_bits_and_bad_input(void **state)
{
    double depths[32];
    struct neph_step_cloud_params params = i3rc_case(4, depths);
    struct neph_step_cloud_fluxes a, b, c;
    params.photons = 1000;
    neph_assert_ok(neph_step_cloud_solve(&params, &a, NULL, NULL), NULL);
    neph_assert_ok(neph_step_cloud_solve(&params, &b, NULL, NULL), NULL);
    params.seed = 1;
    neph_assert_ok(neph_step_cloud_solve(&params, &c, NULL, NULL), NULL);
    assert_true(a.reflected.mean == b.reflected.mean && a.reflected.mean != c.reflected.mean);

    struct neph_diag diag = {.message = ""};
    params.photons = 63;
    assert_int_equal(neph_step_cloud_solve(&params, &a, NULL, &diag), NEPH_ERR_INPUT);
    params.photons = 64;
    depths[5] = NAN;
    assert_int_equal(neph_step_cloud_solve(&params, &a, NULL, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "column 5"));
    depths[5] = 0.0;
    params.sun_cosine = 0.0;
    assert_int_equal(neph_step_cloud_solve(&params, &a, NULL, &diag), NEPH_ERR_INPUT);
}

#include "tests/main.h"

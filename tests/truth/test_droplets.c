/* SPDX-License-Identifier: MIT
 *
 * Droplets of many sizes against moments of their distributions, the integrals of the phase
 * function, and published optics of two clouds; the index of water against published values.
 */
#include "tests/truth/iprt.h"

#include "scenes/density_units.h"
#include "truth/doubling.h"
#include "truth/droplets.h"
#include "truth/mie.h"
#include "truth/water.h"

#include <stdlib.h>

enum { NODES = 400 };

static struct neph_droplet_optics compute(const struct neph_droplets_params *params, double *phase)
{
    struct neph_diag diag = {.message = ""};
    struct neph_droplet_optics optics = {.sphere_count = 0};
    neph_assert_ok(neph_droplets_compute(params, &optics, phase, &diag), &diag);
    return optics;
}

static struct neph_droplets_params make(enum neph_droplet_sizes sizes, double radius_um,
                                        double variance, double wavelength_um)
{
    struct neph_droplets_params params = {sizes,    1e-6 * radius_um,
                                          variance, 1e-6 * wavelength_um,
                                          1.33,     NEPH_WATER_DENSITY_KG_PER_M3,
                                          0,        NULL};
    return params;
}

/* The effective radius is the ratio of the third to the second moment, so extinction per mass is 3
 * Q / (4 density r_e). The mean volume is (1 - v) (1 - 2 v) r_e^3 for the gamma distribution and (1
 * + v)^-3 r_e^3 for the log-normal one (Hansen and Travis 1974). */
static void test_moments(void **state)
{
    for (int sizes = 0; sizes < NEPH_DROPLETS_COUNT; sizes++)
        for (double v = 0.01; v < 0.35; v *= 2.0) {
            const struct neph_droplets_params params = make(sizes, 2.0, v, 0.55);
            const struct neph_droplet_optics optics = compute(&params, NULL);
            const double volume = sizes == NEPH_DROPLETS_GAMMA ? (1.0 - v) * (1.0 - 2.0 * v)
                                                               : pow(1.0 + v, -3.0);
            const double mass_kg = NEPH_WATER_DENSITY_KG_PER_M3 * 4.0 / 3.0 * M_PI * volume * 8e-18;
            /* 1e-8 of the area is cut off at each end, and the largest droplets have the most
             * volume; the smallest, which are cut off, the number. */
            neph_assert_close(optics.extinction_m2_per_kg * 4.0 / 3.0 *
                                  NEPH_WATER_DENSITY_KG_PER_M3 * 2e-6,
                              optics.extinction_efficiency, 1e-5, 0.0);
            neph_assert_close(optics.droplets_per_kg, 1.0 / mass_kg, v > 0.2 ? 2e-2 : 2e-4, 0.0);
        }
}

/* The closed form of scenes/density_units.h for water at 550 nm, within the errors it states. */
static void test_efficiency_of_scenes(void **state)
{
    static const struct {
        double radius_um, variance, error;
    } rows[] = {{2.0, 0.01, 0.025}, {2.0, 0.4, 0.025}, {4.0, 0.4, 0.007}, {10.0, 0.4, 0.0015}};
    struct neph_diag diag = {.message = ""};
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_droplet_radii radii = {rows[i].radius_um, rows[i].variance};
        struct neph_droplets_params params = make(NEPH_DROPLETS_GAMMA, rows[i].radius_um,
                                                  rows[i].variance, 0.55);
        neph_assert_ok(neph_water_index(550e-9, &params.index, &diag), &diag);
        const double q = compute(&params, NULL).extinction_efficiency;
        neph_assert_close(neph_droplet_extinction_efficiency(radii), q, rows[i].error, 0.0);
    }
}

/* A narrow distribution is one sphere where efficiency varies slowly. */
static void test_a_narrow_distribution_is_a_sphere(void **state)
{
    const double x = 1.5;
    struct neph_droplets_params params = make(NEPH_DROPLETS_GAMMA, x / (2.0 * M_PI), 1e-4, 1.0);
    struct neph_mie_efficiency q;
    neph_assert_ok(neph_mie_sphere(x, 1.33, 0, NULL, &q, NULL, NULL), NULL);
    const struct neph_droplet_optics optics = compute(&params, NULL);
    neph_assert_close(optics.extinction_efficiency, q.extinction, 1e-3, 0.0);
    neph_assert_close(optics.asymmetry, q.asymmetry, 1e-3, 0.0);
}

static void test_the_phase_function_is_normalised(void **state)
{
    static double nodes[NODES], weights[NODES], cosines[NODES], phase[NODES];
    neph_gauss_legendre(NODES, nodes, weights);
    for (int i = 0; i < NODES; i++)
        cosines[i] = 2.0 * nodes[i] - 1.0;
    for (int sizes = 0; sizes < NEPH_DROPLETS_COUNT; sizes++) {
        struct neph_droplets_params params = make(sizes, 2.0, 0.1, 0.6);
        params.angle_count = NODES;
        params.cosines = cosines;
        params.index = 1.33 + 1e-4 * I;
        const struct neph_droplet_optics optics = compute(&params, phase);
        double sum = 0.0, forward = 0.0;
        for (int i = 0; i < NODES; i++) {
            sum += 4.0 * M_PI * weights[i] * phase[i];
            forward += 4.0 * M_PI * weights[i] * phase[i] * cosines[i];
        }
        neph_assert_close(sum, 1.0, 1e-9, 0.0);
        neph_assert_close(forward, optics.asymmetry, 0.0, 1e-9);
        assert_true(optics.albedo > 0.9 && optics.albedo < 1.0);
    }
}

/* Water of 20 degrees at the D line of sodium is 1.33299 against air (CRC Handbook), whose index is
 * 1.00027. */
static void test_the_index_of_water(void **state)
{
    double complex index;
    neph_assert_ok(neph_water_index(0.5893e-6, &index, NULL), NULL);
    neph_assert_close(creal(index), 1.33299 * 1.00027, 0.0, 2e-5);
    neph_assert_ok(neph_water_index(0.55e-6, &index, NULL), NULL);
    neph_assert_close(cimag(index), 1.96e-9, 1e-9, 0.0);
    neph_assert_ok(neph_water_index(0.3e-6, &index, NULL), NULL);
    neph_assert_close(cimag(index), 1.60e-8, 1e-9, 0.0);
    neph_assert_ok(neph_water_index(1e-6, &index, NULL), NULL);
    neph_assert_close(cimag(index), 2.89e-6, 1e-9, 0.0);
    assert_int_equal(neph_water_index(0.29e-6, &index, NULL), NEPH_ERR_INPUT);
    assert_int_equal(neph_water_index(NAN, &index, NULL), NEPH_ERR_INPUT);
}

/* The water cloud of C. Emde et al., JQSRT 164 (2015), case A 5: water at 800 nm, gamma
 * distribution of effective radius 10 um: extinction 158.707 /km per g/m3, albedo 0.999979. The
 * variance is the 0.1 of the tables of libRadtran, from which it comes. */
static void test_the_water_cloud_of_iprt(void **state)
{
    struct neph_droplets_params params = make(NEPH_DROPLETS_GAMMA, 10.0, 0.1, 0.8);
    neph_assert_ok(neph_water_index(params.wavelength_m, &params.index, NULL), NULL);
    params.density_kg_per_m3 = 1000.0; /* of those tables */
    const struct neph_droplet_optics optics = compute(&params, NULL);
    neph_assert_close(optics.extinction_m2_per_kg, 158.707, 1e-3, 0.0);
    /* Absorption depends on k, of which measurements differ by a few per cent. */
    neph_assert_close(1.0 - optics.albedo, 1.0 - 0.999979, 0.1, 0.0);
}

/* The phase function of that cloud at each angle of the published file. Its scattering angles of
 * the rainbow fit an index of 1.326, 0.0026 less than that of water; with this index the values
 * agree to 1 %. */
static void test_the_phase_function_of_iprt(void **state)
{
    static struct iprt_phase rows;
    static double cosines[IPRT_ANGLES_MAX], phase[IPRT_ANGLES_MAX];
    iprt_read_phase(&rows);
    struct neph_droplets_params params = make(NEPH_DROPLETS_GAMMA, 10.0, 0.1, 0.8);
    params.index = 1.326;
    params.cosines = cosines;
    params.angle_count = rows.count;
    for (int i = 0; i < rows.count; i++)
        cosines[i] = cos(rows.degrees[i] * M_PI / 180.0);
    compute(&params, phase);
    for (int i = 0; i < rows.count; i++)
        neph_assert_close(4.0 * M_PI * phase[i], rows.values[i], 0.01, 0.0);
}

static void test_refusals(void **state)
{
    struct neph_droplet_optics optics;
    struct neph_droplets_params wrong[8];
    for (int i = 0; i < 8; i++)
        wrong[i] = make(NEPH_DROPLETS_GAMMA, 5.0, 0.1, 0.55);
    wrong[0].effective_radius_m = 0.0;
    wrong[1].effective_radius_m = 1.0; /* the size parameter is out of bounds */
    wrong[2].effective_variance = 0.5;
    wrong[3].effective_variance = NAN;
    wrong[4].wavelength_m = -1.0;
    wrong[5].density_kg_per_m3 = 0.0;
    wrong[6].index = 1.3 - 0.1 * I;
    wrong[7].effective_radius_m = NAN;
    for (int i = 0; i < 8; i++)
        assert_int_equal(neph_droplets_compute(&wrong[i], &optics, NULL, NULL), NEPH_ERR_INPUT);
}

#include "tests/main.h"

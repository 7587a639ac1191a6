/* SPDX-License-Identifier: MIT
 *
 * Mie theory against published cases, the limits of small and large spheres, and its own integrals.
 */
#include "tests/neph_test.h"

#include "truth/doubling.h"
#include "truth/mie.h"

static struct neph_mie_efficiency compute(double x, double complex m, int count,
                                          const double *cosines, double *intensities)
{
    struct neph_diag diag = {.message = ""};
    struct neph_mie_efficiency efficiency = {NAN, NAN, NAN};
    neph_assert_ok(neph_mie_sphere(x, m, count, cosines, &efficiency, intensities, &diag), &diag);
    return efficiency;
}

/* W. J. Wiscombe, "Mie Scattering Calculations", NCAR/TN-140+STR (1979, revised 1996), test cases
 * of MIEV0, to the six decimals printed there; extinction from H. Du, Appl. Opt. 43 (2004), table
 * 1, in seven significant digits. NaN: not printed. */
static void test_published_efficiencies(void **state)
{
    static const struct {
        double x, n, k, extinction, scattering, asymmetry;
    } cases[] = {
        {0.099, 0.75, 0.0, 7.417859e-6, 7.417859e-6, 0.001448},
        {0.101, 0.75, 0.0, 8.033538e-6, 8.033538e-6, 0.001507},
        {10.0, 0.75, 0.0, 2.232265, 2.232265, 0.896473},
        {1000.0, 0.75, 0.0, 1.997908, 1.997908, 0.844944},
        {1.0, 1.33, 1e-5, NAN, 0.093923, 0.184517},
        {100.0, 1.33, 1e-5, 2.101321, 2.096594, 0.868959},
        {10000.0, 1.33, 1e-5, 2.004089, 1.723857, 0.907840},
        {0.055, 1.5, 1.0, 0.10149104, 1.131687e-5, 0.000491},
        {0.056, 1.5, 1.0, 0.1033467, 1.216311e-5, 0.000509},
        {1.0, 1.5, 1.0, 2.336321, 0.6634538, 0.192136},
        {100.0, 1.5, 1.0, 2.097502, 1.283697, 0.850252},
        {10000.0, 1.5, 1.0, 2.004368, 1.236574, 0.846309},
        {1.0, 10.0, 10.0, 2.532993, 2.049405, -0.110664},
        {100.0, 10.0, 10.0, 2.071124, 1.836785, 0.556215},
        {10000.0, 10.0, 10.0, 2.005914, 1.795393, 0.548194},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        const struct neph_mie_efficiency q = compute(cases[i].x, cases[i].n + I * cases[i].k, 0,
                                                     NULL, NULL);
        if (!isnan(cases[i].extinction)) /* one unit of the last of seven digits */
            neph_assert_close(q.extinction, cases[i].extinction, 1e-6, 1e-12);
        neph_assert_close(q.scattering, cases[i].scattering,
                          cases[i].x == 1.0 && cases[i].k == 1e-5 ? 6e-6 : 1e-6, 1e-12);
        neph_assert_close(q.asymmetry, cases[i].asymmetry, 0.0, 1.1e-6);
    }
}

/* Bohren and Huffman 1983, page 482: a sphere of radius 0.525 um and index 1.55 at 0.6328 um, S11
 * over S11 at 0 in steps of 9 degrees, to its six digits (5e-6 is half a unit of the last). */
static void test_published_intensities(void **state)
{
    static const double printed[] = {
        1.0,        0.785390,   0.356897,  0.0766119, 0.0355355,  0.0701845,  0.0574313,
        0.0219660,  0.0125959,  0.0173750, 0.0124601, 0.00679093, 0.00954239, 0.00863419,
        0.00227421, 0.00543998, 0.0160243, 0.0188852, 0.0195254,  0.0301676,  0.0383189,
    };
    enum { ANGLES = sizeof(printed) / sizeof(printed[0]) };
    const double x = 2.0 * M_PI * 0.525 / 0.6328;
    double cosines[ANGLES], intensities[ANGLES];
    for (int i = 0; i < ANGLES; i++)
        cosines[i] = cos(9.0 * i * M_PI / 180.0);
    const struct neph_mie_efficiency q = compute(x, 1.55, ANGLES, cosines, intensities);
    neph_assert_close(q.extinction, 3.10543, 0.0, 6e-6);
    neph_assert_close(q.scattering, 3.10543, 0.0, 6e-6);
    /* Backscattering: 4 S11(180) / x^2. */
    neph_assert_close(4.0 * intensities[ANGLES - 1] / (x * x), 2.92534, 0.0, 6e-6);
    for (int i = 0; i < ANGLES; i++)
        neph_assert_close(intensities[i] / intensities[0], printed[i], 5e-6, 0.0);
}

/* The integral of S11 over all directions is the scattering cross section, and its mean cosine the
 * asymmetry. Both are polynomials in the cosine, so Gauss-Legendre is exact with more nodes than
 * orders. The optical theorem: extinction from the amplitude at 0 (equation 4.76), whose modulus
 * squared is S11. Without absorption extinction and scattering are equal. */
static void test_its_integrals(void **state)
{
    static const struct {
        double x, n, k;
    } cases[] = {{0.01, 1.33, 0.0},
                 {0.7, 1.33, 0.0},
                 {5.0, 1.5, 0.1},
                 {40.0, 1.33, 1e-6},
                 {300.0, 1.33, 0.0}};
    enum { NODES = 400 };
    static double nodes[NODES], weights[NODES], cosines[NODES], intensities[NODES];
    neph_gauss_legendre(NODES, nodes, weights);
    for (int i = 0; i < NODES; i++)
        cosines[i] = 2.0 * nodes[i] - 1.0;
    for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
        const double x = cases[c].x;
        const struct neph_mie_efficiency q = compute(x, cases[c].n + I * cases[c].k, NODES, cosines,
                                                     intensities);
        double sum = 0.0, forward = 0.0;
        for (int i = 0; i < NODES; i++) {
            sum += 2.0 * weights[i] * intensities[i];
            forward += 2.0 * weights[i] * intensities[i] * cosines[i];
        }
        /* The sums have 1e3 terms at most, each with the rounding of the recurrences. */
        neph_assert_close(2.0 * sum / (x * x), q.scattering, 1e-9, 0.0);
        neph_assert_close(forward / sum, q.asymmetry, 0.0, 1e-9);
        if (cases[c].k == 0.0)
            neph_assert_close(q.extinction, q.scattering, 1e-9, 0.0);
    }
}

/* Small spheres scatter as Rayleigh: Q = 8/3 x^4 |(m^2 - 1) / (m^2 + 2)|^2, S11 as 1 + cos^2, and
 * absorb Q = 4 x Im((m^2 - 1) / (m^2 + 2)) (equations 5.8 and 5.9), up to terms of x^2. */
static void test_small_spheres(void **state)
{
    static const double cosines[] = {1.0, 0.5, 0.0, -0.5, -1.0};
    double intensities[5];
    for (double x = 1e-3; x < 0.02; x *= 2.0) {
        const double complex m = 1.33 + 1e-3 * I, polarizability = (m * m - 1.0) / (m * m + 2.0);
        const struct neph_mie_efficiency q = compute(x, m, 5, cosines, intensities);
        const double scattering = 8.0 / 3.0 * pow(x, 4.0) * pow(cabs(polarizability), 2.0);
        neph_assert_close(q.scattering, scattering, 2.0 * x * x, 0.0);
        neph_assert_close(q.extinction - q.scattering, 4.0 * x * cimag(polarizability), 2.0 * x * x,
                          0.0);
        for (int i = 0; i < 5; i++)
            neph_assert_close(intensities[i] / intensities[2], 1.0 + cosines[i] * cosines[i], 0.0,
                              2.0 * x * x);
    }
}

/* Large opaque spheres take twice their shadow from the beam; the excess falls as x^(-2/3) with
 * the factor 1.9924 (H. M. Nussenzveig, W. J. Wiscombe, Phys. Rev. Lett. 45, 1980). All sizes are
 * finite. */
static void test_large_spheres(void **state)
{
    static const double cosines[] = {1.0, 0.99, 0.0, -1.0};
    double intensities[4];
    for (double x = 1e-2; x <= 2e4; x *= 1.9) {
        const struct neph_mie_efficiency q = compute(x, 1.5 + 0.1 * I, 4, cosines, intensities);
        assert_true(q.extinction > 0.0 && q.scattering > 0.0 && q.scattering <= q.extinction);
        assert_true(fabs(q.asymmetry) < 1.0);
        for (int i = 0; i < 4; i++)
            assert_true(isfinite(intensities[i]) && intensities[i] >= 0.0);
        if (x > 100.0) /* the next term is of the order of x^(-1) */
            neph_assert_close(q.extinction, 2.0 + 1.9924 * pow(x, -2.0 / 3.0), 0.0, 4.0 / x);
    }
}

static void test_refusals(void **state)
{
    struct neph_mie_efficiency q;
    static const struct {
        double x;
        double complex m;
    } cases[] = {{0.0, 1.33}, {-1.0, 1.33}, {NAN, 1.33}, {INFINITY, 1.33}, {3e4, 1.33},
                 {1.0, 0.0},  {1.0, -1.3},  {1.0, NAN},  {1.0, 30.0},      {1.0, 1.3 - 0.1 * I}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        assert_int_equal(neph_mie_sphere(cases[i].x, cases[i].m, 0, NULL, &q, NULL, NULL),
                         NEPH_ERR_INPUT);
}

#include "tests/main.h"

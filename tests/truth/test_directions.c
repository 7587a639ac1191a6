/* SPDX-License-Identifier: MIT
 *
 * Random numbers and directions against their distributions.
 */
#include "tests/neph_test.h"

#include "scenes/media.h"
#include "truth/directions.h"

/* ---- random numbers ---- */

static void test_streams_are_reproducible_and_differ(void **state)
{
    struct neph_random a = neph_random_stream(1, 2, 3), again = neph_random_stream(1, 2, 3);
    assert_memory_equal(&a, &again, sizeof(a));
    /* Neighbours, exchanged arguments, and the all-zero start, from which the generator would not
     * move. */
    static const uint64_t others[][3] = {{1, 2, 4}, {1, 3, 3}, {2, 2, 3}, {2, 1, 3},
                                         {1, 3, 2}, {3, 2, 1}, {0, 0, 0}};
    for (size_t i = 0; i < COUNT(others); i++) {
        struct neph_random b = neph_random_stream(others[i][0], others[i][1], others[i][2]);
        assert_true(b.state[0] | b.state[1] | b.state[2] | b.state[3]);
        int equal = 0;
        for (int n = 0; n < 1000; n++)
            equal += neph_random_bits(&a) == neph_random_bits(&b);
        assert_int_equal(equal, 0);
    }
}

/* The first numbers of consecutive streams, as used for pixels and samples: mean, variance and
 * correlation of neighbours, to 4.5 standard errors each. */
static void test_first_numbers_of_streams(void **state)
{
    enum { STREAMS = 200000 };
    double sum = 0.0, squares = 0.0, neighbours = 0.0, before = 0.0;
    for (int n = 0; n < STREAMS; n++) {
        struct neph_random random = neph_random_stream(7, (uint64_t)(n / 16), (uint64_t)(n % 16));
        const double x = neph_random_uniform(&random) - 0.5;
        assert_true(x > -0.5 && x < 0.5);
        sum += x;
        squares += x * x;
        neighbours += x * before;
        before = x;
    }
    const double n = STREAMS, twelfth = 1.0 / 12.0;
    neph_assert_close(sum / n, 0.0, 0.0, 4.5 * sqrt(twelfth / n));
    neph_assert_close(squares / n, twelfth, 0.0, 4.5 * sqrt((1.0 / 80.0 - 1.0 / 144.0) / n));
    neph_assert_close(neighbours / n, 0.0, 0.0, 4.5 * twelfth / sqrt(n));
}

/* ---- phase functions ---- */

static const double asymmetries[] = {0.0,  1e-9,  1e-4, 0.3,  0.6,  0.85,
                                     0.95, 0.999, -0.3, -0.6, -0.9, -0.999};

/* The fraction of light scattered with a cosine below `c`, of Henyey and Greenstein, without
 * cancellation: (1 - g) (1 + c) / (r (1 + r + g)) with r^2 = 1 + g^2 - 2 g c, from expanding the
 * textbook's ((1 - g^2) / r - (1 - g)) / 2 g. */
static double below(double g, double c)
{
    const double r = sqrt((1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c));
    return (1.0 - g) * (1.0 + c) / (r * (1.0 + r + g));
}

/* u -> versine -> u again. The versine is accurate to a few roundings; the change of u by its own
 * rounding (1e-16 next to 2) is allowed. */
static void test_henyey_greenstein_inverts_its_distribution(void **state)
{
    for (size_t i = 0; i < COUNT(asymmetries); i++) {
        const double g = asymmetries[i];
        const struct neph_phase phase = {NEPH_PHASE_HENYEY_GREENSTEIN, g};
        for (double u = 0.001; u < 1.0; u += 0.0127) {
            const double v = neph_phase_versine(&phase, u);
            assert_true(v >= 0.0 && v <= 2.0);
            /* Forward g: u is the fraction below; backward: above in the mirror image. */
            const double found = g >= 0.0 ? below(g, 1.0 - v) : below(-g, v - 1.0);
            const double density = 2.0 * M_PI * neph_phase_per_sr(&phase, 1.0 - v);
            neph_assert_close(found, u, 1e-12, 4e-16 * density);
        }
    }
}

static void test_rayleigh_inverts_its_distribution(void **state)
{
    const struct neph_phase phase = {NEPH_PHASE_RAYLEIGH, 0.0};
    for (double u = 1e-6; u < 1.0; u += 0.00127) {
        const double c = 1.0 - neph_phase_versine(&phase, u);
        neph_assert_close((c * c * c + 3.0 * c + 4.0) / 8.0, u, 1e-14, 1e-15);
    }
}

enum { DRAWS = 100000, BINS = 20 };

/* Directions around a slanted axis: unit; cosines equally frequent in bins of equal probability
 * (chi-square of 19 degrees below its 1e-5 quantile, 58.4); mean cosine g; no preferred azimuth. */
static void check_sampling(const struct neph_phase *phase, double mean, double mean_square)
{
    const struct neph_vec3 axis = neph_vec3_normalize((struct neph_vec3){0.3, -0.5, 0.8});
    struct neph_random random = neph_random_stream(11, 0, 0);
    double edges[BINS], sum = 0.0, chi_square = 0.0;
    struct neph_vec3 across = {0, 0, 0};
    int counts[BINS] = {0};
    for (int b = 0; b < BINS; b++) { /* versine of the upper ends, in the order of the cosine */
        const double share = b == BINS - 1 ? 1.0 : (b + 1.0) / BINS;
        edges[b] = 1.0 - neph_phase_versine(phase, phase->g < 0.0 ? 1.0 - share : share);
    }
    for (int n = 0; n < DRAWS; n++) {
        const struct neph_vec3 d = neph_phase_sample(phase, axis, &random);
        neph_assert_close(neph_vec3_dot(d, d), 1.0, 0.0, 1e-14);
        const double cosine = neph_vec3_dot(d, axis);
        sum += cosine;
        int bin = 0;
        while (bin < BINS - 1 && cosine > edges[bin])
            bin++;
        counts[bin]++;
        const struct neph_vec3 side = neph_vec3_along(d, axis, -cosine);
        const double length = neph_vec3_length(side);
        if (length > 0.0)
            across = neph_vec3_along(across, side, 1.0 / length);
    }
    const double expected = (double)DRAWS / BINS;
    for (int b = 0; b < BINS; b++)
        chi_square += (counts[b] - expected) * (counts[b] - expected) / expected;
    assert_true(chi_square < 58.4);
    neph_assert_close(sum / DRAWS, mean, 0.0,
                      4.0 * sqrt(fmax(0.0, mean_square - mean * mean) / DRAWS) + 1e-12);
    /* A walk of DRAWS unit steps in the plane; beyond 5 sqrt(n) with probability e^-25. */
    assert_true(neph_vec3_length(across) < 5.0 * sqrt(DRAWS));
}

/* <c^2> = (1 + 2 moment) / 3, of the second Legendre polynomial. */
static void test_phase_sampling(void **state)
{
    for (int kind = 0; kind < NEPH_PHASE_KIND_COUNT; kind++)
        for (int i = 0; i < neph_phase_row(kind)->trial_count; i++) {
            const struct neph_phase phase = neph_phase_row(kind)->trials[i];
            check_sampling(&phase, neph_phase_mean_cosine(&phase),
                           (1.0 + 2.0 * neph_phase_moment(&phase, 2)) / 3.0);
        }
}

/* The square of the cosine is uniform; mean 2/3, mean square 1/2. All axes, including the poles. */
static void test_cosine_sampling(void **state)
{
    static const struct neph_vec3 normals[] = {
        {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {-1, 0, 0}, {0.6, 0.0, -0.8}};
    struct neph_random random = neph_random_stream(12, 0, 0);
    for (size_t i = 0; i < COUNT(normals); i++) {
        double sum = 0.0, squares = 0.0;
        for (int n = 0; n < DRAWS; n++) {
            const double c = neph_vec3_dot(neph_cosine_sample(normals[i], &random), normals[i]);
            assert_true(c >= 0.0);
            sum += c;
            squares += c * c;
        }
        neph_assert_close(sum / DRAWS, 2.0 / 3.0, 0.0, 4.0 * sqrt((0.5 - 4.0 / 9.0) / DRAWS));
        neph_assert_close(squares / DRAWS, 0.5, 0.0, 4.0 * sqrt((1.0 / 3.0 - 0.25) / DRAWS));
    }
}

#include "tests/main.h"

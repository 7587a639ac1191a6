/* SPDX-License-Identifier: MIT
 *
 * Slabs against published tables, half-spaces, single scattering, conservation and reciprocity.
 */
#include "tests/neph_test.h"

#include "scenes/media.h"
#include "truth/doubling.h"
#include "scenes/phase_table.h"
#include "truth/slab.h"

static const struct neph_phase isotropic = {NEPH_PHASE_ISOTROPIC, 0.0};
static const struct neph_phase rayleigh = {NEPH_PHASE_RAYLEIGH, 0.0};

static struct neph_phase hg(double g)
{
    return (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, g};
}

static struct neph_slab *make(struct neph_slab_params params)
{
    struct neph_diag diag = {.message = ""};
    struct neph_slab *slab = NULL;
    neph_assert_ok(neph_slab_create(&params, &slab, &diag), &diag);
    return slab;
}

static struct neph_slab_fluxes compute_fluxes(struct neph_slab_params params)
{
    struct neph_slab *slab = make(params);
    const struct neph_slab_fluxes fluxes = neph_slab_fluxes(slab);
    neph_slab_destroy(slab);
    return fluxes;
}

/* ---- isotropic scattering: exact results of analysis ---- */

static void test_h_function(void **state)
{
    neph_assert_close(neph_chandrasekhar_h(1.0, 1.0), 2.907810529, 2e-10, 0.0);
    neph_assert_close(neph_chandrasekhar_h(0.9, 1.0), 1.850098517, 2e-10, 0.0);
    assert_true(neph_chandrasekhar_h(0.7, 0.0) == 1.0);
    assert_true(neph_chandrasekhar_h(0.0, 0.3) == 1.0);
    assert_true(isnan(neph_chandrasekhar_h(1.1, 0.3)));
    assert_true(isnan(neph_chandrasekhar_h(0.5, NAN)));
    /* Its own equation, 1/H(mu) = sqrt(1 - w) + (w/2) int mu' H(mu') / (mu + mu') dmu'; at w = 1
     * also int H = 2. mu' = x^4 removes the logarithms at 0, except for cosines smaller than the
     * nodes. */
    enum { NODES = 60 };
    double x[NODES], weight[NODES];
    neph_gauss_legendre(NODES, x, weight);
    static const double albedos[] = {0.05, 0.5, 0.9, 0.999, 0.999999, 1.0};
    static const double cosines[] = {1e-6, 0.01, 0.1, 0.5, 0.9, 1.0};
    for (size_t a = 0; a < COUNT(albedos); a++) {
        double integral = 0.0, sums[COUNT(cosines)] = {0.0};
        for (int i = 0; i < NODES; i++) {
            const double other = pow(x[i], 4.0);
            const double part = 4.0 * pow(x[i], 3.0) * weight[i] *
                                neph_chandrasekhar_h(albedos[a], other);
            integral += part;
            for (size_t c = 0; c < COUNT(cosines); c++)
                sums[c] += part * other / (cosines[c] + other);
        }
        const double root = sqrt(1.0 - albedos[a]);
        neph_assert_close(integral, 2.0 / albedos[a] * (1.0 - root), 1e-12, 0.0);
        for (size_t c = 0; c < COUNT(cosines); c++)
            neph_assert_close(1.0 / neph_chandrasekhar_h(albedos[a], cosines[c]),
                              root + 0.5 * albedos[a] * sums[c], cosines[c] < 1e-3 ? 1e-9 : 1e-12,
                              0.0);
    }
}

static const double views5[] = {1.0, 0.7, 0.3, 0.05, 0.01};

/* A slab so thick that e^{-k tau} is below rounding. Reflected flux: 1 - sqrt(1 - w) H(mu0). The
 * nodes give 8 digits. */
static void test_half_space(void **state)
{
    static const double albedos[] = {0.2, 0.9, 0.99};
    static const double suns[] = {1.0, 0.7, 0.1};
    for (size_t a = 0; a < COUNT(albedos); a++)
        for (size_t n = 0; n < COUNT(suns); n++) {
            const double w = albedos[a], mu0 = suns[n], h0 = neph_chandrasekhar_h(w, mu0);
            struct neph_slab *slab = make(
                (struct neph_slab_params){200.0, w, isotropic, mu0, COUNT(views5), views5, 0});
            neph_assert_close(neph_slab_fluxes(slab).reflected, 1.0 - sqrt(1.0 - w) * h0, 1e-9,
                              0.0);
            for (int v = 0; v < (int)COUNT(views5); v++) {
                const double mu = views5[v];
                neph_assert_close(neph_slab_reflected_per_sr(slab, v, 1.0),
                                  w / (4.0 * M_PI) * mu0 / (mu + mu0) * h0 *
                                      neph_chandrasekhar_h(w, mu),
                                  1e-8, 0.0);
            }
            neph_slab_destroy(slab);
        }
}

/* Albedo 1, thick: the diffusion limit. The transmitted flux is H(mu0) / (sqrt 3 (tau + 2 q)), q
 * Hopf's constant (Placzek and Seidel 1947), up to e^-tau. The nodes give 8 digits; rounding acts
 * as an absorption of 1e-16 per event; there are tau^2 events. */
static void test_diffusion_limit(void **state)
{
    const double q = 0.710446089598763;
    static const double depths[] = {32.0, 300.0, NEPH_SLAB_OPTICAL_DEPTH_MAX};
    for (size_t i = 0; i < COUNT(depths); i++) {
        const double mu0 = 0.1, h0 = neph_chandrasekhar_h(1.0, mu0);
        struct neph_slab *slab = make(
            (struct neph_slab_params){depths[i], 1.0, isotropic, mu0, COUNT(views5), views5, 0});
        const double transmitted = h0 / (sqrt(3.0) * (depths[i] + 2.0 * q));
        neph_assert_close(neph_slab_fluxes(slab).transmitted, transmitted, 1e-8, 0.0);
        /* The transmitted light has the Milne problem's law of darkening, H(mu). */
        for (int v = 0; v < (int)COUNT(views5); v++)
            neph_assert_close(neph_slab_transmitted_per_sr(slab, v, 0.0),
                              transmitted * mu0 * sqrt(3.0) / (4.0 * M_PI) *
                                  neph_chandrasekhar_h(1.0, views5[v]),
                              1e-8, 0.0);
        neph_slab_destroy(slab);
    }
}

/* ---- tables ---- */

/* HG 0.85, albedo 1, sun cosine 0.7: four digits, on which doubling, cdisort (128 streams) and
 * Monte Carlo agree. */
static void test_cloud_fluxes(void **state)
{
    static const double rows[][3] = {{1.0, 0.0907, 0.9093},
                                     {4.0, 0.3109, 0.6891},
                                     {16.0, 0.6397, 0.3603},
                                     {64.0, 0.8749, 0.1251}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_slab_fluxes f = compute_fluxes(
            (struct neph_slab_params){rows[i][0], 1.0, hg(0.85), 0.7, 0, NULL, 0});
        neph_assert_close(f.reflected, rows[i][1], 0.0, 0.5e-4);
        neph_assert_close(f.transmitted + f.direct, rows[i][2], 0.0, 0.5e-4);
    }
}

/* ---- two orders of scattering, any phase function ---- */

/* int_0^tau e^{-a t - b (tau - t)} dt */
static double pair(double a, double b, double tau)
{
    return tau * exp(-fmin(a, b) * tau) * neph_phi(fabs(a - b) * tau);
}

/* Sunlight scattered at one depth towards the cosine m (up or down), at another to mu (up or down),
 * over both phase functions and albedos: the exponentials integrated over both depths. */
static double twice(double tau, double mu0, double m, bool m_up, double mu, bool up)
{
    const double difference = 1.0 / m - 1.0 / mu0, sum = 1.0 / m + 1.0 / mu0;
    double integral;
    if (up && m_up)
        integral = (pair(1.0 / mu + 1.0 / mu0, 0.0, tau) -
                    exp(-tau / mu0) * pair(1.0 / mu, 1.0 / m, tau)) /
                   sum;
    else if (up)
        integral = (pair(1.0 / mu + 1.0 / mu0, 0.0, tau) - pair(1.0 / mu + 1.0 / m, 0.0, tau)) /
                   difference;
    else if (m_up)
        integral = (pair(1.0 / mu0, 1.0 / mu, tau) -
                    exp(-tau / mu0) * pair(1.0 / mu + 1.0 / m, 0.0, tau)) /
                   sum;
    else
        integral = (pair(1.0 / mu0, 1.0 / mu, tau) - pair(1.0 / m, 1.0 / mu, tau)) / difference;
    return integral / (mu * m);
}

static double turn(double mu_a, double mu_b, bool same_side, double azimuth_rad)
{
    return (same_side ? 1.0 : -1.0) * mu_a * mu_b +
           sqrt((1.0 - mu_a * mu_a) * (1.0 - mu_b * mu_b)) * cos(azimuth_rad);
}

/* The second order's radiance / (E albedo^2), summed over all directions in between. */
static double second_order(const struct neph_phase *phase, double tau, double mu0, double mu,
                           bool up, double azimuth_rad)
{
    enum { NODES = 160, AZIMUTHS = 64 };
    double x[NODES], weight[NODES], sum = 0.0;
    neph_gauss_legendre(NODES, x, weight);
    for (int i = 0; i < NODES; i++)
        for (int side = 0; side < 2; side++) {
            const double m = x[i] * x[i]; /* logarithms at m = 0 */
            double phases = 0.0;
            for (int k = 0; k < AZIMUTHS; k++) {
                const double between = 2.0 * M_PI * k / AZIMUTHS;
                phases += neph_phase_per_sr(phase, turn(mu0, m, side == 0, between)) *
                          neph_phase_per_sr(phase,
                                            turn(m, mu, (side == 1) == up, azimuth_rad - between));
            }
            sum += 2.0 * x[i] * weight[i] * phases * 2.0 * M_PI / AZIMUTHS *
                   twice(tau, mu0, m, side == 1, mu, up);
        }
    return sum;
}

/* Selects from a table of phase functions: all by night; by day the last, which needs most nodes;
 * under the sanitizers the first, which needs fewest. */
static bool is_taken(size_t index, size_t count)
{
    if (NEPH_TEST_EVERY > 1)
        return index == 0;
    return neph_test_is_night() || index + 1 == count;
}

/* (radiance - first order) / albedo^2, extrapolated to albedo 0 from two small ones, which leaves
 * the fourth order: a few times 1e-8. */
static void test_second_order(void **state)
{
    const struct neph_phase phases[] = {isotropic, rayleigh, hg(0.6), hg(-0.4)};
    static const double views[] = {0.95, 0.5, 0.08}, suns[] = {0.77, 0.2},
                        azimuths[] = {0.0, 1.0, M_PI};
    const double tau = 0.8, albedo = 1e-4;
    double worst = 0.0;
    for (size_t n = 0; n < COUNT(phases) * COUNT(suns); n += (size_t)neph_test_path_step()) {
        const struct neph_phase *phase = &phases[n / COUNT(suns)];
        const double mu0 = suns[n % COUNT(suns)];
        struct neph_slab *slabs[2];
        for (int i = 0; i < 2; i++)
            slabs[i] = make((struct neph_slab_params){tau, (i + 1) * albedo, *phase, mu0,
                                                      COUNT(views), views, 0});
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < 6; k++) {
                const bool up = k < 3;
                const double azimuth = azimuths[k % 3], mu = views[v];
                const double once = neph_phase_per_sr(phase, turn(mu0, mu, !up, azimuth)) *
                                    (up ? neph_once_up(tau, mu, mu0)
                                        : neph_once_down(tau, mu, mu0));
                double rest[2];
                for (int i = 0; i < 2; i++) {
                    const double w = (i + 1) * albedo;
                    const double all = up ? neph_slab_reflected_per_sr(slabs[i], v, azimuth)
                                          : neph_slab_transmitted_per_sr(slabs[i], v, azimuth);
                    rest[i] = (all - w * once) / (w * w);
                }
                const double expected = second_order(phase, tau, mu0, mu, up, azimuth);
                const double actual = 2.0 * rest[0] - rest[1];
                worst = fmax(worst, fabs(actual / expected - 1.0));
                neph_assert_close(actual, expected, 1e-7, 0.0);
            }
        neph_slab_destroy(slabs[0]);
        neph_slab_destroy(slabs[1]);
    }
    print_message("worst relative difference from the second order: %.2g\n", worst);
}

/* In a thin slab only the first order remains. Isotropic light of one order produces at most 1 -
 * E2(tau/2) of itself in the next, at the middle of the slab. */
static void test_thin_limit(void **state)
{
    for (double tau = 1e-1; tau > 1e-6; tau *= 0.01) {
        struct neph_slab *slab = make(
            (struct neph_slab_params){tau, 1.0, isotropic, 0.7, COUNT(views5), views5, 0});
        const double x = 0.5 * tau; /* E2(x) = e^-x - x E1(x), E1 by its series */
        const double e1 = -0.57721566490153286 - log(x) + x - x * x / 4.0 + x * x * x / 18.0;
        const double again = 1.0 - (exp(-x) - x * e1);
        for (int v = 0; v < (int)COUNT(views5); v++) {
            const double up = neph_once_up(tau, views5[v], 0.7) / (4.0 * M_PI);
            const double down = neph_once_down(tau, views5[v], 0.7) / (4.0 * M_PI);
            const double most = exp(tau / 0.7 + tau / views5[v]) * again / (1.0 - again);
            const double more_up = neph_slab_reflected_per_sr(slab, v, 2.0) - up;
            const double more_down = neph_slab_transmitted_per_sr(slab, v, 2.0) - down;
            assert_true(more_up > 0.0 && more_up < up * most);
            assert_true(more_down > 0.0 && more_down < down * most);
        }
        neph_slab_destroy(slab);
    }
}

/* ---- properties ---- */

static const struct neph_phase all_phases[] = {
    {NEPH_PHASE_ISOTROPIC, 0.0},           {NEPH_PHASE_RAYLEIGH, 0.0},
    {NEPH_PHASE_HENYEY_GREENSTEIN, 0.85},  {NEPH_PHASE_HENYEY_GREENSTEIN, -0.5},
    {NEPH_PHASE_HENYEY_GREENSTEIN, 0.999}, {NEPH_PHASE_HENYEY_GREENSTEIN, -0.999}};

/* No light is lost at albedo 1: each doubling doubles the previous roundings, 1e-16 * 1e3 / 5e-5 at
 * most. */
static void test_energy_is_conserved(void **state)
{
    static const double depths[] = {1e-8, 1e-3, 0.3, 4.0, 64.0, 1000.0};
    static const double suns[] = {1.0, 0.7, 0.1, NEPH_SLAB_COSINE_MIN};
    double worst = 0.0;
    for (size_t n = 0; n < COUNT(all_phases) * COUNT(depths) * COUNT(suns); n++) {
        const struct neph_phase phase = all_phases[n % COUNT(all_phases)];
        const double depth = depths[n / COUNT(all_phases) % COUNT(depths)];
        const double sun = suns[n / (COUNT(all_phases) * COUNT(depths))];
        const struct neph_slab_fluxes f = compute_fluxes(
            (struct neph_slab_params){depth, 1.0, phase, sun, 0, NULL, 32});
        worst = fmax(worst, fabs(f.reflected + f.transmitted + f.direct - 1.0));
        assert_true(f.reflected > 0.0 && f.transmitted > 0.0);
    }
    print_message("worst |R + T + direct - 1| at albedo 1: %.2g\n", worst);
    assert_true(worst < 1e-10);
}

/* Fluxes are the integrals of the radiances, including first order and azimuths. */
static void test_radiances_integrate_to_fluxes(void **state)
{
    enum { NODES = 64, AZIMUTHS = 160 };
    double cosines[NODES], weight[NODES];
    neph_gauss_legendre(NODES, cosines, weight);
    const struct neph_phase phases[] = {isotropic, rayleigh, hg(0.75), hg(-0.5)};
    for (size_t n = 0; n < COUNT(phases); n++) {
        if (!is_taken(n, COUNT(phases)))
            continue;
        struct neph_slab *slab = make(
            (struct neph_slab_params){2.0, 0.95, phases[n], 0.6, NODES, cosines, 0});
        double up = 0.0, down = 0.0;
        for (int i = 0; i < NODES; i++)
            for (int k = 0; k < AZIMUTHS; k++) {
                const double part = 2.0 * M_PI / AZIMUTHS * weight[i] * cosines[i] / 0.6;
                up += part * neph_slab_reflected_per_sr(slab, i, 2.0 * M_PI * k / AZIMUTHS);
                down += part * neph_slab_transmitted_per_sr(slab, i, 2.0 * M_PI * k / AZIMUTHS);
            }
        neph_assert_close(up, neph_slab_fluxes(slab).reflected, 1e-8, 0.0);
        neph_assert_close(down, neph_slab_fluxes(slab).transmitted, 1e-8, 0.0);
        neph_slab_destroy(slab);
    }
}

/* Henyey-Greenstein as a table of 0.05 degrees, whose straight lines are within 3e-6 of it, has its
 * slab: fluxes, and radiances of all orders. */
static void test_tables_are_their_formula(void **state)
{
    enum { ROWS = 3601 };
    static double angles_deg[ROWS], values[ROWS];
    const struct neph_phase formula = hg(0.75);
    const struct neph_phase_table *table = NULL;
    struct neph_arena arena = {NULL};
    struct neph_diag diag = {0};
    for (int i = 0; i < ROWS; i++) {
        angles_deg[i] = i * 180.0 / (ROWS - 1);
        values[i] = neph_phase_per_sr(&formula, cos(angles_deg[i] * M_PI / 180.0));
    }
    neph_assert_ok(neph_phase_table_make(ROWS, angles_deg, values, &arena, &table, &diag), &diag);
    struct neph_slab_params params = {4.0, 0.99, formula, 0.6, COUNT(views5), views5, 96};
    struct neph_slab *exact = make(params);
    params.phase = (struct neph_phase){.kind = NEPH_PHASE_TABLE, .table = table};
    struct neph_slab *slab = make(params);
    const struct neph_slab_fluxes wanted = neph_slab_fluxes(exact), found = neph_slab_fluxes(slab);
    neph_assert_close(found.reflected, wanted.reflected, 1e-5, 0.0);
    neph_assert_close(found.transmitted, wanted.transmitted, 1e-5, 0.0);
    for (int v = 0; v < (int)COUNT(views5); v++) {
        neph_assert_close(neph_slab_reflected_per_sr(slab, v, 1.0),
                          neph_slab_reflected_per_sr(exact, v, 1.0), 1e-5, 0.0);
        neph_assert_close(neph_slab_transmitted_per_sr(slab, v, 1.0),
                          neph_slab_transmitted_per_sr(exact, v, 1.0), 1e-5, 0.0);
    }
    neph_slab_destroy(exact);
    neph_slab_destroy(slab);
    neph_arena_finish(&arena);
}

/* Sun and view exchanged: radiance / sun cosine is the same. */
static void test_reciprocity(void **state)
{
    const struct neph_phase phases[] = {rayleigh, hg(0.85)};
    const double cosines[] = {0.9, 0.25};
    for (size_t n = 0; n < COUNT(phases); n++) {
        if (!is_taken(n, COUNT(phases)))
            continue;
        struct neph_slab *a = make(
            (struct neph_slab_params){3.0, 0.99, phases[n], cosines[0], 1, &cosines[1], 0});
        struct neph_slab *b = make(
            (struct neph_slab_params){3.0, 0.99, phases[n], cosines[1], 1, &cosines[0], 0});
        for (double azimuth = 0.0; azimuth < 3.2; azimuth += 0.4) {
            neph_assert_close(neph_slab_reflected_per_sr(a, 0, azimuth) / cosines[0],
                              neph_slab_reflected_per_sr(b, 0, azimuth) / cosines[1], 1e-11, 0.0);
            neph_assert_close(neph_slab_transmitted_per_sr(a, 0, azimuth) / cosines[0],
                              neph_slab_transmitted_per_sr(b, 0, azimuth) / cosines[1], 1e-11, 0.0);
        }
        neph_slab_destroy(a);
        neph_slab_destroy(b);
    }
}

/* The same result with other nodes: 8 digits of radiance, also where view and sun coincide; fluxes
 * of the sharpest phase functions to 1e-6. */
static void test_number_of_nodes(void **state)
{
    const struct neph_phase phases[] = {isotropic, rayleigh, hg(0.75)};
    double worst = 0.0;
    for (size_t n = 0; n < COUNT(phases); n++) {
        if (!is_taken(n, COUNT(phases)))
            continue;
        struct neph_slab_params params = {4.0, 1.0, phases[n], 0.7, COUNT(views5), views5, 0};
        struct neph_slab *a = make(params);
        params.node_count = 80;
        struct neph_slab *b = make(params);
        for (int v = 0; v < (int)COUNT(views5); v++)
            for (double azimuth = 0.0; azimuth < 3.2; azimuth += 0.5) {
                worst = fmax(worst, fabs(neph_slab_reflected_per_sr(a, v, azimuth) /
                                             neph_slab_reflected_per_sr(b, v, azimuth) -
                                         1.0));
                worst = fmax(worst, fabs(neph_slab_transmitted_per_sr(a, v, azimuth) /
                                             neph_slab_transmitted_per_sr(b, v, azimuth) -
                                         1.0));
            }
        neph_slab_destroy(a);
        neph_slab_destroy(b);
    }
    print_message("worst relative change of radiance with the nodes: %.2g\n", worst);
    assert_true(worst < 1e-8);
    if (NEPH_TEST_EVERY > 1) /* the same matrices, larger */
        return;
    const struct neph_slab_params sharp = {10.0, 1.0, hg(0.999), 0.3, 0, NULL, 0};
    struct neph_slab_params sharp_other = sharp;
    sharp_other.node_count = 160;
    neph_assert_close(compute_fluxes(sharp).reflected, compute_fluxes(sharp_other).reflected, 0.0,
                      1e-6);
}

/* ---- extremes --- */

static void test_nothing_there(void **state)
{
    struct neph_slab *empty = make(
        (struct neph_slab_params){0.0, 1.0, hg(0.5), 0.5, COUNT(views5), views5, 0});
    struct neph_slab *black = make(
        (struct neph_slab_params){2.0, 0.0, hg(0.5), 0.5, COUNT(views5), views5, 0});
    assert_true(neph_slab_fluxes(empty).direct == 1.0 && neph_slab_fluxes(empty).reflected == 0.0);
    neph_assert_close(neph_slab_fluxes(black).direct, exp(-4.0), 1e-15, 0.0);
    assert_true(neph_slab_fluxes(black).reflected == 0.0);
    for (int v = 0; v < (int)COUNT(views5); v++) {
        assert_true(neph_slab_reflected_per_sr(empty, v, 0.0) == 0.0);
        assert_true(neph_slab_transmitted_per_sr(empty, v, 0.0) == 0.0);
        assert_true(neph_slab_transmitted_per_sr(black, v, 0.0) == 0.0);
    }
    neph_slab_destroy(empty);
    neph_slab_destroy(black);
    neph_slab_destroy(NULL);
}

static void test_refused_parameters(void **state)
{
    static const double sideways[] = {0.5, 0.0};
    const struct {
        struct neph_slab_params params;
        enum neph_status status;
        const char *words;
    } cases[] = {
        {{NAN, 1.0, isotropic, 0.5, 0, NULL, 0}, NEPH_ERR_INPUT, "optical depth"},
        {{1e7, 1.0, isotropic, 0.5, 0, NULL, 0}, NEPH_ERR_INPUT, "optical depth"},
        {{1.0, 1.1, isotropic, 0.5, 0, NULL, 0}, NEPH_ERR_INPUT, "albedo"},
        {{1.0, 1.0, hg(1.0), 0.5, 0, NULL, 0}, NEPH_ERR_INPUT, "asymmetry"},
        {{1.0, 1.0, isotropic, 0.0, 0, NULL, 0}, NEPH_ERR_INPUT, "sun"},
        {{1.0, 1.0, isotropic, 0.5, 2, sideways, 0}, NEPH_ERR_INPUT, "view 1"},
        {{1.0, 1.0, isotropic, 0.5, 0, NULL, 1}, NEPH_ERR_INPUT, "nodes"},
        {{1.0, 1.0, hg(0.95), 0.5, 1, sideways, 0}, NEPH_ERR_UNSUPPORTED, "radiances"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_slab *slab = NULL;
        struct neph_diag diag = {.message = ""};
        assert_int_equal(neph_slab_create(&cases[i].params, &slab, &diag), cases[i].status);
        assert_null(slab);
        assert_non_null(strstr(diag.message, cases[i].words));
    }
}

#include "tests/main.h"

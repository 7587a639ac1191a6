/* SPDX-License-Identifier: MIT
 *
 * The adaptive rule on integrals with closed form: accurate to 1e-13, with a valid error estimate.
 */
#include "tests/neph_test.h"

#include "scenes/quadrature.h"

#include <float.h>

/* Three channels of one integrand: f, 2 f and -f/3, so that swapped channels are detected. */
struct scalar {
    double (*function)(double x, double p);
    double parameter;
    long evaluations;
};

static void three_channels(double x, void *context, double value[3])
{
    struct scalar *scalar = context;
    const double y = scalar->function(x, scalar->parameter);
    scalar->evaluations++;
    value[0] = y;
    value[1] = 2.0 * y;
    value[2] = -y / 3.0;
}

static double power(double x, double p)
{
    return pow(x, p);
}

static double decay(double x, double p)
{
    return exp(-p * x);
}

static double bell(double x, double p)
{
    return exp(-0.5 * (x - 0.3) * (x - 0.3) * p * p);
}

static double lorentz(double x, double p)
{
    return p / (M_PI * (x * x + p * p));
}

static double wave(double x, double p)
{
    return cos(p * x);
}

static double square_root(double x, double p)
{
    return sqrt(x) * p;
}

static double step(double x, double p)
{
    return x < p ? 1.0 : 0.0;
}

static double kink(double x, double p)
{
    return fabs(x - p);
}

struct known {
    const char *name;
    double (*function)(double x, double p);
    double parameter, low, high, integral;
};

/* Analytic on the closed interval, so the rule converges as fast as it can. */
static const struct known analytic[] = {
    {"1", power, 0.0, -3.0, 4.0, 7.0},
    {"x^2", power, 2.0, 0.0, 3.0, 9.0},
    {"x^31", power, 31.0, 0.0, 1.0, 1.0 / 32.0}, /* the rule's own degree */
    {"e^-x", decay, 1.0, 0.0, 1.0, 0.63212055882855767840447622983853913},
    {"e^-x to 50", decay, 1.0, 0.0, 50.0, 1.0},
    {"e^-1000x", decay, 1e3, 0.0, 1.0, 1e-3},
    {"e^+20x", decay, -20.0, 0.0, 1.0, 24258259.720489513898}, /* (e^20 - 1)/20 */
    {"tiny", decay, 1.0, 0.0, 1e-12, 9.999999999995e-13},
    /* A bell much narrower than the nodes' spacing of 0.15 needs the caller's cuts. */
    {"bell of width 1/30", bell, 30.0, -1.0, 1.0, 0.083554275821033350080},
    {"peak of width 1e-2", lorentz, 1e-2, -1.0, 1.0, 0.99363401447018348970}, /* 2/pi atan 100 */
    {"cos 30x", wave, 30.0, 0.0, 1.0, -0.032934387469762059656},              /* sin(30)/30 */
};

/* Not analytic: sqrt at its branch, a step and a kink inside a piece. The remaining error after 20
 * halvings. */
static const struct known rough[] = {
    {"sqrt", square_root, 1.0, 0.0, 1.0, 2.0 / 3.0},
    {"step", step, 1.0 / 3.0, 0.0, 1.0, 1.0 / 3.0},
    {"kink", kink, 1.0 / 3.0, 0.0, 1.0, 5.0 / 18.0},
};

static double integrate(const struct known *known, double result[3], long *evaluations)
{
    struct scalar scalar = {known->function, known->parameter, 0};
    const struct neph_interval piece = {known->low, known->high};
    const double error = neph_integrate(three_channels, &scalar, &piece, 1, result);
    *evaluations = scalar.evaluations;
    return error;
}

static void test_known_integrals(void **state)
{
    for (size_t i = 0; i < COUNT(analytic); i++) {
        double result[3];
        long evaluations;
        integrate(&analytic[i], result, &evaluations);
        const double expected = analytic[i].integral;
        print_message("%-20s off by %8.1e, %ld evaluations\n", analytic[i].name,
                      result[0] / expected - 1.0, evaluations);
        neph_assert_close(result[0], expected, 1e-13, 0.0);
        neph_assert_close(result[1], 2.0 * expected, 1e-13, 0.0);
        neph_assert_close(result[2], -expected / 3.0, 1e-13, 0.0);
    }
}

/* The estimate is for the worst channel; rounding is 1e-15 of each summed value. */
static void assert_honest(const struct known *known)
{
    double result[3];
    long evaluations;
    const double estimate = integrate(known, result, &evaluations);
    const double truth = fabs(result[1] - 2.0 * known->integral);
    if (!(truth <= estimate + 4e-15 * fabs(2.0 * known->integral)))
        print_error("%s: true error %g, estimated %g\n", known->name, truth, estimate);
    assert_true(truth <= estimate + 4e-15 * fabs(2.0 * known->integral));
}

static void test_error_estimate_is_not_too_small(void **state)
{
    for (size_t i = 0; i < COUNT(analytic); i++)
        assert_honest(&analytic[i]);
    for (size_t i = 0; i < COUNT(rough); i++)
        assert_honest(&rough[i]);
}

/* An integrand that changes sign: its integral is small compared with its terms. */
static void test_error_estimate_where_signs_cancel(void **state)
{
    for (double frequency = 10.0; frequency < 200.0; frequency += 0.37) {
        const struct known known = {"wave",    wave,
                                    frequency, -0.5,
                                    1.0,       (sin(frequency) + sin(0.5 * frequency)) / frequency};
        double result[3];
        long evaluations;
        const double estimate = integrate(&known, result, &evaluations);
        const double truth = fabs(result[1] - 2.0 * known.integral);
        if (!(truth <= estimate + 1e-14))
            print_error("cos %gx: true error %g, estimated %g\n", frequency, truth, estimate);
        assert_true(truth <= estimate + 1e-14);
    }
}

static void test_rough_integrands_end(void **state)
{
    for (size_t i = 0; i < COUNT(rough); i++) {
        double result[3];
        long evaluations;
        integrate(&rough[i], result, &evaluations);
        neph_assert_close(result[0], rough[i].integral, 0.0, 1e-7);
        assert_true(evaluations < 21 * 200);
    }
}

/* Pieces add, gaps count nothing, and a piece that is negligible is not refined. */
static void test_union_of_pieces(void **state)
{
    struct scalar scalar = {decay, 1.0, 0};
    const struct neph_interval pieces[] = {{0.0, 1.0}, {2.0, 3.0}, {100.0, 101.0}};
    double result[3];
    neph_integrate(three_channels, &scalar, pieces, 3, result);
    const double expected = -expm1(-1.0) - exp(-2.0) * expm1(-1.0) - exp(-100.0) * expm1(-1.0);
    neph_assert_close(result[0], expected, 1e-14, 0.0);

    neph_integrate(three_channels, &scalar, pieces, 0, result);
    assert_true(result[0] == 0.0 && result[1] == 0.0 && result[2] == 0.0);

    /* e^{300 (x - 1)} needs halving where it matters; next to 1e20 it does not matter. */
    struct scalar steep = {decay, -300.0, 0};
    const struct neph_interval both[] = {{0.0, 0.1}, {0.9, 1.0}};
    neph_integrate(three_channels, &steep, &both[1], 1, result);
    const long alone = steep.evaluations;
    steep.evaluations = 0;
    neph_integrate(three_channels, &steep, both, 2, result);
    assert_true(steep.evaluations <= alone + 2 * 21);
}

/* All zero is not an error and ends at once. */
static void test_nothing(void **state)
{
    struct scalar scalar = {square_root, 0.0, 0};
    const struct neph_interval piece = {0.0, 1.0};
    double result[3];
    const double error = neph_integrate(three_channels, &scalar, &piece, 1, result);
    assert_true(error == 0.0 && result[0] == 0.0);
    assert_true(scalar.evaluations <= 42);
}

#include "tests/main.h"

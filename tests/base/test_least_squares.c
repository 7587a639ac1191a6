/* SPDX-License-Identifier: MIT
 *
 * Least squares on a certified problem, from its own starts, against bounds, with an unknown that
 * has no influence, and a failing residual; inverses of matrices.
 */
#include "tests/neph_test.h"

#include "base/least_squares.h"

/* NIST StRD, nonlinear regression, Misra1a: y = b1 (1 - exp(-b2 x)). */
static const double misra_y[] = {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02,
                                 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78};
static const double misra_x[] = {77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                                 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0};
enum { MISRA = 14 };

static enum neph_status misra_residuals(void *context, const double *b, double *residuals,
                                        struct neph_diag *diag)
{
    for (int i = 0; i < MISRA; i++)
        residuals[i] = b[0] * (1.0 - exp(-b[1] * misra_x[i])) - misra_y[i];
    return context ? neph_fail(diag, NEPH_ERR_INTERRUPTED, "stopped") : NEPH_OK;
}

static enum neph_status misra_slopes(void *context, const double *b, const double *residuals,
                                     double *const *slopes, struct neph_diag *diag)
{
    for (int i = 0; i < MISRA; i++) {
        slopes[0][i] = 1.0 - exp(-b[1] * misra_x[i]);
        slopes[1][i] = b[0] * misra_x[i] * exp(-b[1] * misra_x[i]);
        if (b[2] != 0.0)
            slopes[2][i] = 0.0;
    }
    return NEPH_OK;
}

static const struct neph_least_squares misra = {.unknown_count = 2,
                                                .residual_count = MISRA,
                                                .find_residuals = misra_residuals,
                                                .find_slopes = misra_slopes,
                                                .tolerance = 1e-14,
                                                .iterations_max = 200};

static void test_a_certified_problem(void **state)
{
    static const double starts[][3] = {{500.0, 1e-4}, {250.0, 5e-4}};
    for (size_t i = 0; i < COUNT(starts); i++) {
        double b[3] = {starts[i][0], starts[i][1]}, squares;
        neph_assert_ok(neph_least_squares_solve(&misra, b, &squares, NULL), NULL);
        neph_assert_close(b[0], 2.3894212918e+02, 1e-6, 0.0);
        neph_assert_close(b[1], 5.5015643181e-04, 1e-6, 0.0);
        neph_assert_close(squares, 1.2455138894e-01, 1e-9, 0.0);
    }
}

/* At the bound b1 = 200 the best b2 has no slope left; an unknown without influence stays. */
static void test_bounds_and_an_idle_unknown(void **state)
{
    static const double low[] = {0.0, 0.0, -1.0}, high[] = {200.0, 1.0, 1.0};
    struct neph_least_squares problem = misra;
    double b[3] = {150.0, 5e-4, 0.5}, squares, residuals[MISRA], slope = 0.0;
    problem.unknown_count = 3;
    problem.low = low;
    problem.high = high;
    neph_assert_ok(neph_least_squares_solve(&problem, b, &squares, NULL), NULL);
    neph_assert_close(b[0], 200.0, 0.0, 0.0);
    neph_assert_close(b[2], 0.5, 0.0, 0.0);
    misra_residuals(NULL, b, residuals, NULL);
    for (int i = 0; i < MISRA; i++)
        slope += residuals[i] * misra_x[i] * exp(-b[1] * misra_x[i]);
    neph_assert_close(slope, 0.0, 0.0, 1e-2); /* of terms near 100 */
}

static void test_an_error_changes_nothing(void **state)
{
    struct neph_least_squares problem = misra;
    struct neph_diag diag = {.message = ""};
    double b[3] = {500.0, 1e-4}, squares = -1.0;
    problem.context = &diag;
    assert_int_equal(neph_least_squares_solve(&problem, b, &squares, &diag), NEPH_ERR_INTERRUPTED);
    neph_assert_close(b[0], 500.0, 0.0, 0.0);
    neph_assert_close(squares, -1.0, 0.0, 0.0);
}

static void test_inverses(void **state)
{
    /* Of the Hilbert matrix of order 4, over a wide range of units. */
    static const double inverse[4][4] = {{16, -120, 240, -140},
                                         {-120, 1200, -2700, 1680},
                                         {240, -2700, 6480, -4200},
                                         {-140, 1680, -4200, 2800}};
    static const double unit[] = {1.0, 1e6, 1e-6, 30.0};
    double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX];
    for (int k = 0; k < 4; k++)
        for (int l = 0; l < 4; l++)
            matrix[k][l] = unit[k] * unit[l] / (k + l + 1);
    assert_true(neph_positive_invert(4, matrix));
    for (int k = 0; k < 4; k++)
        for (int l = 0; l < 4; l++)
            neph_assert_close(matrix[k][l] * unit[k] * unit[l], inverse[k][l], 1e-11, 0.0);
    for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++)
            matrix[k][l] = 1.0;
    assert_false(neph_positive_invert(2, matrix));
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Least squares on a certified problem, from its own starts, against bounds, with an unknown that
 * has no influence, and a failing residual; eigenvalues of matrices.
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

/* A sum that is enough ends the search before it is least. */
static void test_enough_is_enough(void **state)
{
    struct neph_least_squares problem = misra;
    double b[3] = {500.0, 1e-4}, squares;
    problem.enough = 100.0;
    neph_assert_ok(neph_least_squares_solve(&problem, b, &squares, NULL), NULL);
    assert_true(squares <= 100.0 && squares > 0.13);
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

/* Eigenvalues of the matrix of second differences of order n: 2 - 2 cos(k pi / (n + 1)), and its
 * vectors are sines; and of a matrix of rank 1. */
static void test_eigenvalues(void **state)
{
    enum { N = NEPH_UNKNOWNS_MAX };
    double matrix[N][N] = {{0.0}}, values[N], vectors[N][N];
    for (int k = 0; k < N; k++) {
        matrix[k][k] = 2.0;
        if (k > 0)
            matrix[k][k - 1] = matrix[k - 1][k] = -1.0;
    }
    neph_symmetric_eigen(N, matrix, values, vectors);
    for (int i = 0; i < N; i++) {
        const double k = round(acos(1.0 - 0.5 * values[i]) * (N + 1) / M_PI);
        neph_assert_close(values[i], 2.0 - 2.0 * cos(k * M_PI / (N + 1)), 0.0, 1e-13);
        for (int j = 0; j < N; j++)
            neph_assert_close(fabs(vectors[i][j]),
                              fabs(sqrt(2.0 / (N + 1)) * sin(k * (j + 1) * M_PI / (N + 1))), 0.0,
                              1e-12);
    }
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++)
            matrix[k][l] = (k + 1) * (l + 1);
    neph_symmetric_eigen(3, matrix, values, vectors);
    double sum = 0.0, most = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += fabs(values[i]);
        most = fmax(most, values[i]);
    }
    neph_assert_close(most, 14.0, 1e-14, 0.0);
    neph_assert_close(sum, 14.0, 1e-14, 0.0);
}

#include "tests/main.h"

/* SPDX-License-Identifier: MIT
 *
 * Nonlinear least squares with few unknowns, by the method of Levenberg and Marquardt (D. W.
 * Marquardt, SIAM J. 11 (1963), with his scaling of the damping), optionally within bounds.
 */
#ifndef NEPH_BASE_LEAST_SQUARES_H
#define NEPH_BASE_LEAST_SQUARES_H

#include "base/status.h"

#include <stdbool.h>

enum { NEPH_UNKNOWNS_MAX = 16 };

struct neph_least_squares {
    int unknown_count, residual_count; /* 1..NEPH_UNKNOWNS_MAX; >= 1 */
    /* Compute all residuals at `x`. */
    enum neph_status (*find_residuals)(void *context, const double *x, double *residuals,
                                       struct neph_diag *diag);
    /* Compute the derivative of every residual by each unknown at `x`; `residuals` are those at
     * `x`. */
    enum neph_status (*find_slopes)(void *context, const double *x, const double *residuals,
                                    double *const *slopes, struct neph_diag *diag);
    void *context;
    const double *low, *high; /* bounds of the unknowns; NULL: none */
    double tolerance;         /* an iteration that improves the sum by less is the last: relative */
    double smallest_step;     /* so is one that moves no unknown by more */
    double enough;            /* a sum that is not above it ends the search */
    int iterations_max;
};

/* Move `x`, the start, to a local minimum of the sum of squares. Errors: memory, and those of both
 * functions; `x` is then unchanged. A start at which the sum is not finite stays. */
enum neph_status neph_least_squares_solve(const struct neph_least_squares *problem, double *x,
                                          double *squares, struct neph_diag *diag);

/* Eigenvalues of a symmetric matrix of count x count, and its eigenvectors of length 1: vectors[i]
 * is the one of values[i]. By rotations of Jacobi (Numer. Math. 9 (1966), 1), relative accuracy
 * 1e-14 of the largest. `matrix` is undefined afterwards. */
void neph_symmetric_eigen(int count, double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX],
                          double values[NEPH_UNKNOWNS_MAX],
                          double vectors[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX]);

#endif

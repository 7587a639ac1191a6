/* SPDX-License-Identifier: MIT */
#include "base/least_squares.h"

#include "base/arena.h"

#include <math.h>
#include <string.h>

struct normal {
    double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX], right[NEPH_UNKNOWNS_MAX];
};

struct search {
    const struct neph_least_squares *problem;
    double x[NEPH_UNKNOWNS_MAX], damping, squares;
    double *residuals, *moved;         /* at `x`, and at a trial point */
    double *slopes[NEPH_UNKNOWNS_MAX]; /* Jacobian: all residuals by each unknown */
};

static double dot(const double *a, const double *b, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

static struct normal make_normal_equations(const struct search *search)
{
    const int unknowns = search->problem->unknown_count, count = search->problem->residual_count;
    struct normal normal = {.right = {0.0}};
    for (int k = 0; k < unknowns; k++) {
        for (int l = 0; l < unknowns; l++)
            normal.matrix[k][l] = dot(search->slopes[k], search->slopes[l], count);
        normal.right[k] = -dot(search->slopes[k], search->residuals, count);
    }
    return normal;
}

/* An unknown at a bound that descent would cross stays there, and one without influence does. */
static void fix_unknowns(const struct search *search, struct normal *normal)
{
    const struct neph_least_squares *problem = search->problem;
    for (int k = 0; k < problem->unknown_count; k++) {
        const double down = normal->right[k]; /* the direction of descent */
        const bool is_stuck = problem->low && ((search->x[k] <= problem->low[k] && down < 0.0) ||
                                               (search->x[k] >= problem->high[k] && down > 0.0));
        if (!is_stuck && normal->matrix[k][k] > 0.0)
            continue;
        for (int l = 0; l < problem->unknown_count; l++)
            normal->matrix[k][l] = normal->matrix[l][k] = 0.0;
        normal->matrix[k][k] = 1.0;
        normal->right[k] = 0.0;
    }
}

/* Gaussian elimination. The damped matrix is positive definite, so no pivoting is needed. */
static void solve(struct normal normal, int unknowns, double damping, double *step)
{
    for (int k = 0; k < unknowns; k++)
        normal.matrix[k][k] *= 1.0 + damping;
    for (int k = 0; k < unknowns; k++)
        for (int row = k + 1; row < unknowns; row++) {
            const double factor = normal.matrix[row][k] / normal.matrix[k][k];
            for (int l = k; l < unknowns; l++)
                normal.matrix[row][l] -= factor * normal.matrix[k][l];
            normal.right[row] -= factor * normal.right[k];
        }
    for (int k = unknowns - 1; k >= 0; k--) {
        step[k] = normal.right[k];
        for (int l = k + 1; l < unknowns; l++)
            step[k] -= normal.matrix[k][l] * step[l];
        step[k] /= normal.matrix[k][k];
    }
}

static void move(const struct search *search, const double *step, double *moved)
{
    const struct neph_least_squares *problem = search->problem;
    for (int k = 0; k < problem->unknown_count; k++) {
        moved[k] = search->x[k] + step[k];
        if (problem->low)
            moved[k] = fmin(fmax(moved[k], problem->low[k]), problem->high[k]);
    }
}

static bool is_small(const struct search *search, const double *moved)
{
    for (int k = 0; k < search->problem->unknown_count; k++)
        if (fabs(moved[k] - search->x[k]) > search->problem->smallest_step)
            return false;
    return true;
}

static void accept(struct search *search, const double *x, double squares)
{
    double *residuals = search->residuals;
    search->residuals = search->moved;
    search->moved = residuals;
    memcpy(search->x, x, sizeof(search->x));
    search->squares = squares;
    search->damping = fmax(search->damping / 8.0, 1e-9);
}

/* One step of descent; raises the damping until the sum decreases. `*is_done`: converged. */
static enum neph_status descend(struct search *search, bool *is_done, struct neph_diag *diag)
{
    const struct neph_least_squares *problem = search->problem;
    enum neph_status status = problem->find_slopes(problem->context, search->x, search->residuals,
                                                   search->slopes, diag);
    if (status)
        return status;
    struct normal normal = make_normal_equations(search);
    fix_unknowns(search, &normal);
    for (; search->damping < 1e9; search->damping *= 4.0) {
        double step[NEPH_UNKNOWNS_MAX], moved[NEPH_UNKNOWNS_MAX] = {0.0};
        solve(normal, problem->unknown_count, search->damping, step);
        move(search, step, moved);
        status = problem->find_residuals(problem->context, moved, search->moved, diag);
        if (status)
            return status;
        const double squares = dot(search->moved, search->moved, problem->residual_count);
        *is_done = is_small(search, moved);
        if (!(squares < search->squares) && *is_done)
            return NEPH_OK;
        if (!(squares < search->squares))
            continue;
        *is_done |= squares <= problem->enough;
        *is_done |= !(search->squares - squares > problem->tolerance * search->squares);
        accept(search, moved, squares);
        return NEPH_OK;
    }
    *is_done = true;
    return NEPH_OK;
}

enum neph_status neph_least_squares_solve(const struct neph_least_squares *problem, double *x,
                                          double *squares, struct neph_diag *diag)
{
    const size_t unknowns = (size_t)problem->unknown_count, count = (size_t)problem->residual_count;
    struct neph_arena arena = {.last = NULL};
    struct search search = {.problem = problem, .damping = 1e-2};
    bool is_done = false;
    memcpy(search.x, x, unknowns * sizeof(*x));
    search.residuals = neph_arena_allocate(&arena, count, sizeof(double));
    search.moved = neph_arena_allocate(&arena, count, sizeof(double));
    for (size_t k = 0; k < unknowns; k++)
        search.slopes[k] = neph_arena_allocate(&arena, count, sizeof(double));
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = problem->find_residuals(problem->context, search.x, search.residuals, diag);
    if (!status)
        search.squares = dot(search.residuals, search.residuals, problem->residual_count);
    is_done = search.squares <= problem->enough;
    for (int i = 0; i < problem->iterations_max && !is_done && !status; i++)
        status = descend(&search, &is_done, diag);
    if (!status) {
        memcpy(x, search.x, unknowns * sizeof(*x));
        *squares = search.squares;
    }
    neph_arena_finish(&arena);
    return status;
}

/* Rotate rows and columns k and l so that the element (k, l) becomes 0. */
static void rotate(int count, double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX],
                   double vectors[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX], int k, int l)
{
    const double angle = 0.5 * atan2(2.0 * matrix[k][l], matrix[l][l] - matrix[k][k]);
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < count; i++) {
        const double a = matrix[i][k], b = matrix[i][l];
        matrix[i][k] = c * a - s * b;
        matrix[i][l] = s * a + c * b;
    }
    for (int i = 0; i < count; i++) {
        const double a = matrix[k][i], b = matrix[l][i], v = vectors[k][i], w = vectors[l][i];
        matrix[k][i] = c * a - s * b;
        matrix[l][i] = s * a + c * b;
        vectors[k][i] = c * v - s * w;
        vectors[l][i] = s * v + c * w;
    }
}

void neph_symmetric_eigen(int count, double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX],
                          double values[NEPH_UNKNOWNS_MAX],
                          double vectors[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX])
{
    enum { SWEEPS = 12 }; /* convergence is quadratic: 16 unknowns need 6 to 8 */
    for (int k = 0; k < count; k++)
        for (int l = 0; l < count; l++)
            vectors[k][l] = k == l;
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int k = 0; k < count; k++)
            for (int l = k + 1; l < count; l++)
                if (matrix[k][l] != 0.0)
                    rotate(count, matrix, vectors, k, l);
    for (int k = 0; k < count; k++)
        values[k] = matrix[k][k];
}

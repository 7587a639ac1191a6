/* SPDX-License-Identifier: MIT
 *
 * Intervals of a fit: the inverse of the normal matrix without the directions that have no
 * influence on the residuals, for three kinds of errors: independent residuals, residuals that are
 * correlated within tiles or rows of them, and errors of the model.
 */
#include "harness/fit/intervals.h"

#include "base/arena.h"
#include "base/least_squares.h"

#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_FIT_QUANTITY_COUNT == 2, "a new quantity");

enum { VALUES = NEPH_FIT_VALUES, UNKNOWNS = NEPH_FIT_UNKNOWN_COUNT };

static const double normal_95 = 1.959964; /* quantile of the normal distribution */

/* ---- intervals ------------------------------------------------------------------------------- */

/* Symmetric, of the unknowns of a problem in their order there. */
struct matrix {
    double at[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX];
};

struct errors {
    /* For residuals of variance 1, without directions of no influence; 0 of what is fixed. */
    double inverse[UNKNOWNS][UNKNOWNS];
    double undetermined[UNKNOWNS][UNKNOWNS];     /* covariance of directions without influence */
    double tiles[NEPH_FIT_TILE_COUNT][UNKNOWNS]; /* by how much the residuals of a tile move it */
    double *shifts[UNKNOWNS];                    /* by how much each value moves an unknown */
    double variance;                             /* of a residual */
};

/* Add v v^T / value, or the prior's variance along v if the value is 0 within the precision of the
 * slopes. */
static void add_direction(const struct neph_fit_problem *problem, const double *vector,
                          double value, double inverse[UNKNOWNS][UNKNOWNS],
                          double undetermined[UNKNOWNS][UNKNOWNS])
{
    const double least = 1e-9;
    double length = 0.0;
    for (int k = 0; k < problem->count; k++)
        length += vector[k] * vector[k];
    for (int k = 0; k < problem->count; k++)
        for (int l = 0; l < problem->count; l++) {
            const int row = problem->unknowns[k], column = problem->unknowns[l];
            if (value > least)
                inverse[row][column] += vector[k] * vector[l] / value;
            else
                undetermined[row][column] += vector[k] * vector[l] / length *
                                             NEPH_FIT_PRIOR_DEVIATION * NEPH_FIT_PRIOR_DEVIATION;
        }
}

/* Add the inverse of a matrix by its eigenvectors, after scaling to a diagonal of 1. */
static void invert(const struct neph_fit_problem *problem, struct matrix matrix,
                   double inverse[UNKNOWNS][UNKNOWNS], double undetermined[UNKNOWNS][UNKNOWNS])
{
    double scale[UNKNOWNS], values[NEPH_UNKNOWNS_MAX];
    double vectors[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX];
    for (int k = 0; k < problem->count; k++)
        scale[k] = matrix.at[k][k] > 0.0 ? 1.0 / sqrt(matrix.at[k][k]) : 1.0;
    for (int k = 0; k < problem->count; k++)
        for (int l = 0; l < problem->count; l++)
            matrix.at[k][l] *= scale[k] * scale[l];
    neph_symmetric_eigen(problem->count, matrix.at, values, vectors);
    for (int i = 0; i < problem->count; i++) {
        for (int k = 0; k < problem->count; k++)
            vectors[i][k] *= scale[k];
        add_direction(problem, vectors[i], values[i], inverse, undetermined);
    }
}

/* The normal matrix of the values in a tile, or (-1) in all; and its right side. */
static struct matrix sum_tile(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                              double *const *slopes, const double *residuals, int tile,
                              double right[UNKNOWNS])
{
    struct matrix matrix = {{{0.0}}};
    for (int i = 0; i < neph_fit_count_values(fit); i++) {
        if (tile >= 0 && fit->pixels->list[i / VALUES].tile != tile)
            continue;
        for (int k = 0; k < problem->count; k++) {
            right[k] += slopes[k][i] * residuals[i];
            for (int l = 0; l < problem->count; l++)
                matrix.at[k][l] += slopes[k][i] * slopes[l][i];
        }
    }
    return matrix;
}

/* By how much a tile moves the unknowns: the fit without it is elsewhere, by (N - N_tile)^-1 J^T r,
 * the jackknife (Efron and Stein, Ann. Stat. 9 (1981), 586). 0.9 of a tile is left out: what only
 * one tile determines stays determined. */
static void find_tile_moves(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                            double *const *slopes, const double *residuals,
                            const struct matrix *whole, struct errors *errors)
{
    const double part = 0.9;
    for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++) {
        double right[UNKNOWNS] = {0.0}, unused[UNKNOWNS][UNKNOWNS] = {{0.0}};
        double inverse[UNKNOWNS][UNKNOWNS] = {{0.0}};
        const struct matrix own = sum_tile(fit, problem, slopes, residuals, t, right);
        struct matrix rest = *whole;
        for (int k = 0; k < problem->count; k++)
            for (int l = 0; l < problem->count; l++)
                rest.at[k][l] -= part * own.at[k][l];
        invert(problem, rest, inverse, unused);
        for (int k = 0; k < problem->count; k++)
            for (int l = 0; l < problem->count; l++)
                errors->tiles[t][problem->unknowns[k]] +=
                    inverse[problem->unknowns[k]][problem->unknowns[l]] * right[l];
    }
}

static void find_shifts(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                        double *const *slopes, struct errors *errors)
{
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        for (int k = 0; k < problem->count; k++)
            for (int l = 0; l < problem->count; l++)
                errors->shifts[problem->unknowns[k]][i] +=
                    errors->inverse[problem->unknowns[k]][problem->unknowns[l]] * slopes[l][i];
}

static void find_errors(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                        double *const *slopes, const double *residuals, struct errors *errors)
{
    double unused[UNKNOWNS] = {0.0};
    const struct matrix whole = sum_tile(fit, problem, slopes, residuals, -1, unused);
    invert(problem, whole, errors->inverse, errors->undetermined);
    find_shifts(fit, problem, slopes, errors);
    find_tile_moves(fit, problem, slopes, residuals, &whole, errors);
}

/* The variance of a sum of unknowns by two relative errors up to NEPH_FIT_MODEL_ERROR of a
 * quantity: one of all values, and one of all in a tile. */
static double find_model_variance(const struct neph_fit *fit, const struct errors *errors,
                                  const double factors[UNKNOWNS])
{
    double moved[NEPH_FIT_TILE_COUNT][NEPH_FIT_QUANTITY_COUNT] = {{0.0}}, sum = 0.0;
    for (int i = 0; i < neph_fit_count_values(fit); i++) {
        const struct neph_fit_pixel *pixel = &fit->pixels->list[i / VALUES];
        double shift = 0.0;
        for (int k = 0; k < UNKNOWNS; k++)
            shift += factors[k] * errors->shifts[k][i];
        moved[pixel->tile][neph_fit_quantity_at(i)] +=
            shift * fit->weights[i] *
            neph_fit_sensitivity(pixel->values[i % VALUES], neph_fit_quantity_at(i));
    }
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++) {
        double all = 0.0;
        for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++) {
            all += moved[t][q];
            sum += moved[t][q] * moved[t][q];
        }
        sum += all * all;
    }
    return sum * NEPH_FIT_MODEL_ERROR * NEPH_FIT_MODEL_ERROR / 3.0;
}

/* The variance by the moves of tiles: the largest of independent tiles, of whole rows and of whole
 * columns of them. Errors of another renderer follow a horizon or an edge, and have one sign all
 * along it. */
static double find_tile_variance(const double moves[NEPH_FIT_TILE_COUNT])
{
    double tiles = 0.0, rows = 0.0, columns = 0.0;
    for (int i = 0; i < NEPH_FIT_TILES; i++) {
        double row = 0.0, column = 0.0;
        for (int j = 0; j < NEPH_FIT_TILES; j++) {
            row += moves[i * NEPH_FIT_TILES + j];
            column += moves[j * NEPH_FIT_TILES + i];
            tiles += moves[i * NEPH_FIT_TILES + j] * moves[i * NEPH_FIT_TILES + j];
        }
        rows += row * row;
        columns += column * column;
    }
    return fmax(tiles, fmax(rows, columns));
}

/* The estimate of a sum of unknowns. The variance by residuals is the larger of two: of independent
 * residuals, and of residuals that are correlated within tiles or rows of them. */
static struct neph_fit_estimate estimate(const struct neph_fit *fit, const struct errors *errors,
                                         const struct neph_fit_point *point,
                                         const double factors[UNKNOWNS], bool is_factor)
{
    double value = 0.0, variance = 0.0, undetermined = 0.0, moves[NEPH_FIT_TILE_COUNT] = {0.0};
    for (int k = 0; k < UNKNOWNS; k++) {
        value += factors[k] * point->x[k];
        for (int l = 0; l < UNKNOWNS; l++) {
            variance += factors[k] * factors[l] * errors->inverse[k][l] * errors->variance;
            undetermined += factors[k] * factors[l] * errors->undetermined[k][l];
        }
    }
    for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++)
        for (int k = 0; k < UNKNOWNS; k++)
            moves[t] += factors[k] * errors->tiles[t][k];
    variance = fmax(variance, find_tile_variance(moves)) +
               find_model_variance(fit, errors, factors) + undetermined;
    const double half = normal_95 * sqrt(variance);
    if (!is_factor)
        return (struct neph_fit_estimate){value, value - half, value + half, true,
                                          2.0 * half <= NEPH_FIT_WIDEST_ASYMMETRY};
    return (struct neph_fit_estimate){exp(value), exp(value - half), exp(value + half), true,
                                      2.0 * half <= log(NEPH_FIT_WIDEST_FACTOR)};
}

/* By how much more the residuals move the unknowns than independent ones would. */
static double find_inflation(const struct errors *errors)
{
    double inflation = 1.0;
    for (int k = 0; k < UNKNOWNS; k++) {
        double tiles = 0.0;
        for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++)
            tiles += errors->tiles[t][k] * errors->tiles[t][k];
        if (errors->inverse[k][k] > 0.0)
            inflation = fmax(inflation, tiles / (errors->inverse[k][k] * errors->variance));
    }
    return fmin(inflation, 100.0);
}

static void fill_estimates(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                           const struct errors *errors, struct neph_fit_estimates *estimates)
{
    static const double product[UNKNOWNS] = {[NEPH_FIT_EXTINCTION] = 1.0, [NEPH_FIT_ALBEDO] = 1.0};
    for (int k = 0; k < UNKNOWNS; k++) {
        const double x = estimates->point.x[k], own = k == NEPH_FIT_ASYMMETRY ? x : exp(x);
        estimates->list[k] = (struct neph_fit_estimate){own, own, own, false, true};
    }
    for (int i = 0; i < problem->count; i++) {
        const int k = problem->unknowns[i];
        double one[UNKNOWNS] = {0.0};
        one[k] = 1.0;
        estimates->list[k] = estimate(fit, errors, &estimates->point, one, k != NEPH_FIT_ASYMMETRY);
    }
    estimates->scattering = estimate(fit, errors, &estimates->point, product, true);
    estimates->noise = find_inflation(errors) * errors->variance;
}

/* The variance of a residual; at least that by the rounding of floats. */
static double find_variance(const struct neph_fit *fit, const struct neph_fit_problem *problem,
                            double squares)
{
    int count = 0;
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        count += fit->weights[i] != 0.0;
    return fmax(squares / fmax(count - problem->count, 1.0), 1e-8);
}

enum neph_status neph_fit_find_intervals(struct neph_fit *fit, const struct neph_fit_range *range,
                                         struct neph_fit_estimates *estimates,
                                         struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct neph_fit_problem problem = {.fit = fit, .base = &base, .point = estimates->point};
    struct neph_arena arena = {.last = NULL};
    struct errors *errors = neph_arena_allocate(&arena, 1, sizeof(*errors));
    const size_t count = (size_t)neph_fit_count_residuals(fit);
    double *residuals = neph_arena_allocate(&arena, count, sizeof(double)), x[UNKNOWNS];
    double *slopes[UNKNOWNS];
    for (int k = 0; k < UNKNOWNS; k++) {
        slopes[k] = neph_arena_allocate(&arena, count, sizeof(double));
        if (errors)
            errors->shifts[k] = neph_arena_allocate(&arena, count, sizeof(double));
        if (range->low.x[k] < range->high.x[k]) {
            x[problem.count] = estimates->point.x[k];
            problem.unknowns[problem.count++] = k;
        }
    }
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = neph_fit_find_residuals(&problem, x, residuals, diag);
    if (!status)
        status = neph_fit_find_slopes(&problem, x, residuals, slopes, diag);
    if (!status) {
        errors->variance = find_variance(fit, &problem, estimates->squares);
        find_errors(fit, &problem, slopes, residuals, errors);
        fill_estimates(fit, &problem, errors, estimates);
    }
    neph_arena_finish(&arena);
    return status;
}

/* ---- what is not determined ------------------------------------------------------------------ */

/* Hold an unknown that is not determined at the scene's value, if that explains the frame as well.
 * */
static enum neph_status hold(struct neph_fit *fit, int unknown, struct neph_fit_range *range,
                             struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    const double own = neph_fit_scene_point(fit->scene).x[unknown];
    struct neph_fit_range narrow = *range;
    struct neph_fit_estimates held = fit->held;
    if (!held.list[unknown].is_free || held.list[unknown].is_determined)
        return NEPH_OK;
    narrow.low.x[unknown] = narrow.high.x[unknown] = own;
    enum neph_status status = neph_fit_minimise(fit, &base, &narrow, 0.0, &held.point,
                                                &held.squares, diag);
    if (status || held.squares > neph_fit_limit(fit, 1))
        return status;
    status = neph_fit_find_intervals(fit, &narrow, &held, diag);
    fit->held = held;
    fit->is_held[unknown] = true;
    *range = narrow;
    return status;
}

/* The largest (smallest, if `step` < 0) factor of extinction that explains the frame as well: by
 * steps, then by bisection. Infinity, or 0: all within four decades do. */
static enum neph_status find_extinction_end(struct neph_fit *fit,
                                            const struct neph_fit_range *range, double step,
                                            double *end, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    const double limit = neph_fit_limit(fit, 1), farthest = 4.0 * log(10.0), finest = 0.1,
                 sign = step > 0.0 ? 1.0 : -1.0;
    struct neph_fit_point point = fit->held.point;
    double good = point.x[NEPH_FIT_EXTINCTION];
    bool is_found = false;
    while (fabs(step) > finest && sign * good < farthest) {
        struct neph_fit_range at = *range;
        struct neph_fit_point other = point;
        double squares;
        at.low.x[NEPH_FIT_EXTINCTION] = at.high.x[NEPH_FIT_EXTINCTION] = good + step;
        const enum neph_status status = neph_fit_minimise(fit, &base, &at, limit, &other, &squares,
                                                          diag);
        if (status)
            return status;
        is_found |= squares > limit;
        if (squares <= limit) {
            good += step;
            point = other;
        }
        step *= is_found ? 0.5 : 1.0;
    }
    *end = sign * good < farthest ? exp(good) : sign > 0.0 ? INFINITY : 0.0;
    return NEPH_OK;
}

enum neph_status neph_fit_find_held(struct neph_fit *fit, struct neph_diag *diag)
{
    static const int order[] = {NEPH_FIT_FALLOFF, NEPH_FIT_ASYMMETRY, NEPH_FIT_ALBEDO};
    struct neph_fit_range range = neph_fit_whole_range(fit);
    enum neph_status status = NEPH_OK;
    fit->held = fit->best;
    for (size_t i = 0; i < sizeof(order) / sizeof(order[0]) && !status; i++)
        status = hold(fit, order[i], &range, diag);
    const struct neph_fit_estimate *extinction = &fit->held.list[NEPH_FIT_EXTINCTION];
    fit->extinction_min = extinction->low;
    fit->extinction_max = extinction->high;
    if (status || extinction->is_determined)
        return status;
    status = find_extinction_end(fit, &range, 1.5, &fit->extinction_max, diag);
    return status ? status : find_extinction_end(fit, &range, -1.5, &fit->extinction_min, diag);
}

/* SPDX-License-Identifier: MIT */
#include "harness/fit/problem.h"

#include "base/least_squares.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_FIT_QUANTITY_COUNT == 2, "a new quantity");

enum { VALUES = NEPH_FIT_VALUES, UNKNOWNS = NEPH_FIT_UNKNOWN_COUNT };

/* The unknowns in a simple order of magnitude: logarithms of factors, and g. */
static const double widest[UNKNOWNS] = {
    [NEPH_FIT_EXTINCTION] = 11.5, [NEPH_FIT_ALBEDO] = 11.5, [NEPH_FIT_FALLOFF] = 9.2};
static const double asymmetry_max = 0.98;

/* Quantiles of chi squared of 1 and 2 degrees of freedom. */
static const double chi_squared_99[] = {6.635, 9.210};

int neph_fit_count_values(const struct neph_fit *fit)
{
    return fit->pixels->count * VALUES;
}

int neph_fit_count_residuals(const struct neph_fit *fit)
{
    return neph_fit_count_values(fit) + UNKNOWNS;
}

int neph_fit_quantity_at(int value)
{
    return value % VALUES / 3;
}

double neph_fit_sensitivity(double value, int quantity)
{
    if (quantity == NEPH_FIT_RADIANCE)
        return value;
    const double transmittance = fmin(fmax(value, 1e-9), 1.0);
    return -transmittance * log(transmittance);
}

enum neph_status neph_fit_find_residuals(void *context, const double *x, double *residuals,
                                         struct neph_diag *diag)
{
    struct neph_fit_problem *problem = context;
    struct neph_fit *fit = problem->fit;
    struct neph_fit_point point = problem->point;
    for (int k = 0; k < problem->count; k++)
        point.x[problem->unknowns[k]] = x[k];
    const enum neph_status status = neph_fit_predict(fit->model, problem->base, &point,
                                                     fit->transfer, fit->predicted, diag);
    for (int i = 0; i < neph_fit_count_values(fit) && !status; i++) {
        const double *values = fit->pixels->list[i / VALUES].values;
        residuals[i] = fit->weights[i] == 0.0
                           ? 0.0
                           : fit->weights[i] * (fit->predicted[i] - values[i % VALUES]);
    }
    const struct neph_fit_point own = neph_fit_scene_point(fit->scene);
    for (int k = 0; k < UNKNOWNS; k++)
        residuals[neph_fit_count_values(fit) + k] =
            k == NEPH_FIT_EXTINCTION ? 0.0 : (point.x[k] - own.x[k]) / NEPH_FIT_PRIOR_DEVIATION;
    return status;
}

/* Central differences: a step of 1e-3 has a relative error of 1e-6, in logarithms and in g. */
enum neph_status neph_fit_find_slopes(void *context, const double *x, const double *residuals,
                                      double *const *slopes, struct neph_diag *diag)
{
    const double step = 1e-3;
    const struct neph_fit_problem *problem = context;
    const int count = neph_fit_count_residuals(problem->fit);
    double *low = malloc((size_t)count * sizeof(*low));
    enum neph_status status = low ? NEPH_OK : neph_fail_memory(diag);
    (void)residuals;
    for (int k = 0; k < problem->count && !status; k++) {
        double moved[UNKNOWNS];
        memcpy(moved, x, (size_t)problem->count * sizeof(*x));
        moved[k] = x[k] - step;
        status = neph_fit_find_residuals(context, moved, low, diag);
        moved[k] = x[k] + step;
        if (!status)
            status = neph_fit_find_residuals(context, moved, slopes[k], diag);
        for (int i = 0; i < count && !status; i++)
            slopes[k][i] = (slopes[k][i] - low[i]) / (2.0 * step);
    }
    free(low);
    return status;
}

struct neph_fit_range neph_fit_whole_range(const struct neph_fit *fit)
{
    const struct neph_fit_point own = neph_fit_scene_point(fit->scene);
    struct neph_fit_range range = {own, own};
    for (int k = 0; k < UNKNOWNS; k++) {
        const double high = k == NEPH_FIT_ASYMMETRY ? asymmetry_max : widest[k];
        range.low.x[k] = fit->is_free[k] ? -high : own.x[k];
        range.high.x[k] = fit->is_free[k] ? high : own.x[k];
    }
    return range;
}

enum neph_status neph_fit_minimise(struct neph_fit *fit, const struct neph_fit_base *base,
                                   const struct neph_fit_range *range, double enough,
                                   struct neph_fit_point *point, double *squares,
                                   struct neph_diag *diag)
{
    struct neph_fit_problem problem = {.fit = fit, .base = base, .point = *point};
    double x[UNKNOWNS], low[UNKNOWNS], high[UNKNOWNS];
    for (int k = 0; k < UNKNOWNS; k++) {
        problem.point.x[k] = fmin(fmax(point->x[k], range->low.x[k]), range->high.x[k]);
        if (range->low.x[k] < range->high.x[k]) {
            x[problem.count] = problem.point.x[k];
            low[problem.count] = range->low.x[k];
            high[problem.count] = range->high.x[k];
            problem.unknowns[problem.count++] = k;
        }
    }
    const struct neph_least_squares solver = {.unknown_count = problem.count,
                                              .residual_count = neph_fit_count_residuals(fit),
                                              .find_residuals = neph_fit_find_residuals,
                                              .find_slopes = neph_fit_find_slopes,
                                              .context = &problem,
                                              .low = low,
                                              .high = high,
                                              .tolerance = 1e-5,
                                              .smallest_step = 1e-5,
                                              .enough = enough,
                                              .iterations_max = 30};
    const enum neph_status status = neph_least_squares_solve(&solver, x, squares, diag);
    for (int k = 0; k < problem.count && !status; k++)
        problem.point.x[problem.unknowns[k]] = x[k];
    if (!status)
        *point = problem.point;
    return status;
}

double neph_fit_limit(const struct neph_fit *fit, int restricted)
{
    return fit->best.squares + chi_squared_99[restricted - 1] * fmax(fit->best.noise, 1.0);
}

/* SPDX-License-Identifier: MIT */
#include "harness/fit/residuals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_FIT_QUANTITY_COUNT == 2, "a new quantity");

enum { VALUES = NEPH_FIT_VALUES, UNKNOWNS = NEPH_FIT_UNKNOWN_COUNT };

int neph_fit_count_values(const struct neph_fit *fit)
{
    return fit->pixels->count * VALUES;
}

/* Values, and one of the prior for each unknown. */
int neph_fit_count_residuals(const struct neph_fit *fit)
{
    return neph_fit_count_values(fit) + UNKNOWNS;
}

int neph_fit_quantity_at(int value)
{
    return value % VALUES / 3;
}

/* What a relative error of radiance, or of the optical depth of a transmittance, is multiplied by. */
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
        const double *values = &fit->pixels->list[i / VALUES].values[0][0];
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

/* SPDX-License-Identifier: MIT
 *
 * What the parts of a fit share: residuals and their slopes, and intervals.
 */
#ifndef NEPH_HARNESS_FIT_RESIDUALS_H
#define NEPH_HARNESS_FIT_RESIDUALS_H

#include "harness/fit/fit.h"

/* Values of a pixel. */
enum { NEPH_FIT_VALUES = NEPH_FIT_QUANTITY_COUNT * 3 };

/* Standard deviation of a weak prior: what the data do not tell stays near the scene's value, in g
 * and in the logarithms of factors. Extinction has none: of a pair that is not determined, it takes
 * the difference from the scene. */
#define NEPH_FIT_PRIOR_DEVIATION 10.0

/* A least-squares problem over some of the unknowns. */
struct neph_fit_problem {
    struct neph_fit *fit;
    const struct neph_fit_base *base;
    struct neph_fit_point point; /* with the values of unknowns that are held fixed */
    int unknowns[NEPH_FIT_UNKNOWN_COUNT], count;
};

/* Values of all pixels; and residuals: one of each value, and one of the prior of each unknown. */
int neph_fit_count_values(const struct neph_fit *fit);
int neph_fit_count_residuals(const struct neph_fit *fit);

/* The quantity of a value, by its index. */
int neph_fit_quantity_at(int value);

/* Radiance, or the optical depth of a transmittance: by what a relative error of it is multiplied. */
double neph_fit_sensitivity(double value, int quantity);

/* Residuals and their slopes by the unknowns at `x`, for neph_least_squares_solve(); `context` is a
 * struct neph_fit_problem. */
enum neph_status neph_fit_find_residuals(void *context, const double *x, double *residuals,
                                         struct neph_diag *diag);
enum neph_status neph_fit_find_slopes(void *context, const double *x, const double *residuals,
                                      double *const *slopes, struct neph_diag *diag);

/* Intervals of the unknowns that are free within the range, for the point and the squares of
 * `estimates`. */
enum neph_status neph_fit_find_intervals(struct neph_fit *fit, const struct neph_fit_range *range,
                                         struct neph_fit_estimates *estimates,
                                         struct neph_diag *diag);

/* Set `held`, `is_held` and the ends of the extinction by `best`. */
enum neph_status neph_fit_find_held(struct neph_fit *fit, struct neph_diag *diag);

#endif

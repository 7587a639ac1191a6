/* SPDX-License-Identifier: MIT
 *
 * What a fit determines, and how well.
 */
#ifndef NEPH_HARNESS_FIT_INTERVALS_H
#define NEPH_HARNESS_FIT_INTERVALS_H

#include "harness/fit/problem.h"

/* Intervals of the unknowns that are free within the range, for the point and the squares of
 * `estimates`. */
enum neph_status neph_fit_find_intervals(struct neph_fit *fit, const struct neph_fit_range *range,
                                         struct neph_fit_estimates *estimates,
                                         struct neph_diag *diag);

/* Set `held`, `is_held` and the ends of the extinction by `best`. */
enum neph_status neph_fit_find_held(struct neph_fit *fit, struct neph_diag *diag);

#endif

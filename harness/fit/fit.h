/* SPDX-License-Identifier: MIT
 *
 * The medium that explains a frame best: unknowns of a scene's media by weighted least squares,
 * with intervals. All media have the same unknowns.
 */
#ifndef NEPH_HARNESS_FIT_FIT_H
#define NEPH_HARNESS_FIT_FIT_H

#include "harness/fit/problem.h"

/* Fit. `is_free` and the two pointers are set; unknowns with an obstacle (neph_fit_obstacle()) are
 * held fixed. NEPH_ERR_INTERRUPTED, NEPH_ERR_MEMORY. */
enum neph_status neph_fit_solve(struct neph_fit *fit, struct neph_diag *diag);
void neph_fit_finish(struct neph_fit *fit);

#endif

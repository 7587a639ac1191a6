/* SPDX-License-Identifier: MIT
 *
 * What the physics suite looks like: the truth of every view and the frames of every participant as
 * pictures of a report.
 */
#ifndef NEPH_HARNESS_PHYSICS_PICTURES_H
#define NEPH_HARNESS_PHYSICS_PICTURES_H

#include "harness/physics/results.h"

/* Difference maps end at this fraction of the view's mean true radiance (one number for all checks:
 * a scale that is fitted hides what it should show). */
#define NEPH_PHYSICS_DIFFERENCE_SCALE 0.1

/* Fill what a report says of a view. The truth, pixel by pixel [W m^-2 sr^-1], is borrowed. */
void neph_physics_view_describe(const struct neph_check_view *view, const double *truth_w_per_m2_sr,
                                struct neph_physics_view *described);

/* Draw the pictures of the suite into `folder`, a report: images/physics/..., and name them in its
 * views and rows; a view that has a picture was drawn before and is left as it is. NULL is fine. */
enum neph_status neph_physics_pictures(struct neph_physics *physics, const char *folder,
                                       struct neph_diag *diag);

#endif

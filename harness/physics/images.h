/* SPDX-License-Identifier: MIT
 *
 * Images of the physics suite for the report: the reference of every view and the frames of every
 * participant.
 */
#ifndef NEPH_HARNESS_PHYSICS_IMAGES_H
#define NEPH_HARNESS_PHYSICS_IMAGES_H

#include "harness/physics/results.h"

/* End of the colour scale of difference maps, as a fraction of the view's mean reference radiance.
 * It is the same for all checks: a fitted scale would hide the size of an error. */
#define NEPH_PHYSICS_DIFFERENCE_SCALE 0.1

/* Fill the report's data of a view. The reference, pixel by pixel [W m^-2 sr^-1], is borrowed. */
void neph_physics_view_describe(const struct neph_check_view *view, const double *truth_w_per_m2_sr,
                                struct neph_physics_view *described);

/* Draw the images of the suite into images/physics/ of a report's folder, and store their names in
 * the views and rows of `physics`. Views with an image are skipped. NULL is allowed. */
enum neph_status neph_physics_images(struct neph_physics *physics, const char *folder,
                                     struct neph_diag *diag);

#endif

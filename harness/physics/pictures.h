/* SPDX-License-Identifier: MIT
 *
 * What the physics suite looks like: the truth of every view and the frames of every participant as
 * pictures of a report. The truth is no renderer's frame: it travels in the document, pixel by
 * pixel, until the pictures are drawn.
 */
#ifndef NEPH_HARNESS_PHYSICS_PICTURES_H
#define NEPH_HARNESS_PHYSICS_PICTURES_H

#include "harness/json.h"
#include "harness/physics/checks.h"

/* Difference maps end at this fraction of the view's mean true radiance (one number for all checks:
 * a scale that is fitted hides what it should show). */
#define NEPH_PHYSICS_DIFFERENCE_SCALE 0.1

/* One entry of a check's "views" (scripts/report/README.md), with the true radiance of its pixels
 * [W m^-2 sr^-1] in "truth". The caller's; NULL without memory. */
json_t *neph_physics_view_json(const struct neph_check_view *view, const double *truth_w_per_m2_sr);

/* Draw the pictures of the suite's document into `folder`, a report: images/physics/..., name them
 * in the document, and take "truth" out of it; a view without it was drawn before and is left as it
 * is. Frames are those named in the rows' "exr". */
enum neph_status neph_physics_pictures(json_t *physics, const char *folder, struct neph_diag *diag);

#endif

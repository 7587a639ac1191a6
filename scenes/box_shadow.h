/* SPDX-License-Identifier: MIT
 *
 * The part of a ray from which a box hides a light. Private to scenes/.
 */
#ifndef NEPH_SCENES_BOX_SHADOW_H
#define NEPH_SCENES_BOX_SHADOW_H

#include "scenes/scene.h"

/* An affine function of the distance u along a ray. */
struct neph_affine {
    double constant, slope;
};

/* Narrows [*u0, *u1] to the part with f(u) <= g(u); false when nothing remains. */
bool neph_clip_less_equal(struct neph_affine f, struct neph_affine g, double *u0, double *u1);

/* Narrows [*u0, *u1] to the shadow of an axis-aligned box; false when nothing remains. */
bool neph_box_shadow(const struct neph_bounds *box, struct neph_vec3 sun, struct neph_vec3 o,
                     struct neph_vec3 d, double *u0, double *u1);

/* The same, for a point light. */
bool neph_box_point_shadow(const struct neph_bounds *box, struct neph_vec3 light_m,
                           struct neph_vec3 o, struct neph_vec3 d, double *u0, double *u1);

#endif

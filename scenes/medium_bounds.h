/* SPDX-License-Identifier: MIT
 *
 * The bounds of a medium, which may be turned about their middle. They clip the medium; its density
 * is not turned.
 */
#ifndef NEPH_SCENES_MEDIUM_BOUNDS_H
#define NEPH_SCENES_MEDIUM_BOUNDS_H

#include "scenes/bounds.h"

/* Turns the finite bounds of a medium: `bounds` becomes the box around them. */
void neph_medium_turn_bounds(struct neph_medium *medium, const struct neph_turn *turn);

/* Translates them. */
void neph_medium_move_bounds(struct neph_medium *medium, struct neph_vec3 by_m);

/* Whether a point is inside; faces are. */
bool neph_medium_contains(const struct neph_medium *medium, struct neph_vec3 point_m);

/* Clips t in [*t0_m, *t1_m] to the inside; false when nothing remains. */
bool neph_medium_clip(const struct neph_medium *medium, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m);

/* The bounds as a box along axes of their own, and a point and a direction in these axes. */
struct neph_bounds neph_medium_own_box(const struct neph_medium *medium);
struct neph_vec3 neph_medium_own_point_m(const struct neph_medium *medium,
                                         struct neph_vec3 point_m);
struct neph_vec3 neph_medium_own_direction(const struct neph_medium *medium,
                                           struct neph_vec3 direction);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Axis-aligned boxes; a side may be at infinity.
 */
#ifndef NEPH_SCENES_BOUNDS_H
#define NEPH_SCENES_BOUNDS_H

#include "scenes/scene.h"

/* Faces belong to the box. */
bool neph_bounds_contain(const struct neph_bounds *bounds, struct neph_vec3 point_m);

/* Whether a minimum is above its maximum. */
bool neph_bounds_are_empty(const struct neph_bounds *bounds);

/* Clips t in [*t0_m, *t1_m] to the inside of the bounds; false when nothing remains. */
bool neph_bounds_clip(const struct neph_bounds *bounds, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m);

/* Narrows [*t0, *t1] to minimum <= origin + t direction <= maximum on one axis; false when nothing
 * remains. */
bool neph_clip_axis(double minimum, double maximum, double origin, double direction, double *t0,
                    double *t1);

/* Intersection of `a` and `b`; where it is empty, a minimum is above its maximum. */
struct neph_bounds neph_bounds_intersect(struct neph_bounds a, struct neph_bounds b);

/* The smallest box around both. */
struct neph_bounds neph_bounds_hull(struct neph_bounds a, struct neph_bounds b);

/* Intersection of `a` and `b`; on axes where it is empty, a point of `a`. */
struct neph_bounds neph_bounds_narrow(struct neph_bounds a, struct neph_bounds b);

/* The middle of a box with finite sides. */
struct neph_vec3 neph_bounds_middle(const struct neph_bounds *box);

/* The point of a box that is nearest to a point. */
struct neph_vec3 neph_bounds_nearest(const struct neph_bounds *box, struct neph_vec3 point_m);

/* The corner that is farthest from a point. */
struct neph_vec3 neph_bounds_farthest(const struct neph_bounds *box, struct neph_vec3 point_m);

/* Translates both corners; infinite sides stay. */
struct neph_bounds neph_bounds_translate(struct neph_bounds bounds, struct neph_vec3 by_m);

/* The box around a ball. */
struct neph_bounds neph_bounds_around(struct neph_vec3 center_m, double radius_m);

#endif

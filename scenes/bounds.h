/* SPDX-License-Identifier: MIT
 *
 * Axis-aligned boxes, whose sides may be infinitely far.
 */
#ifndef NEPH_SCENES_BOUNDS_H
#define NEPH_SCENES_BOUNDS_H

#include "scenes/scene.h"

/* Faces belong to the box. */
bool neph_bounds_contain(const struct neph_bounds *bounds, struct neph_vec3 point_m);

/* Whether a minimum is above its maximum. */
bool neph_bounds_are_empty(const struct neph_bounds *bounds);

/* Clip t in [*t0_m, *t1_m] to the inside of the bounds; false when nothing is left. */
bool neph_bounds_clip(const struct neph_bounds *bounds, struct neph_vec3 origin_m,
                      struct neph_vec3 direction, double *t0_m, double *t1_m);

/* One axis of it: narrow [*t0, *t1] to minimum <= origin + t direction <= maximum. */
bool neph_clip_axis(double minimum, double maximum, double origin, double direction, double *t0,
                    double *t1);

/* The part of `a` that lies in `b`; where nothing does, a minimum is above its maximum. */
struct neph_bounds neph_bounds_intersect(struct neph_bounds a, struct neph_bounds b);

/* The smallest box that holds both. */
struct neph_bounds neph_bounds_hull(struct neph_bounds a, struct neph_bounds b);

/* The part of `a` that lies in `b`, shrunk to a point on the axes where nothing does. */
struct neph_bounds neph_bounds_narrow(struct neph_bounds a, struct neph_bounds b);

/* The place of a box that is nearest to a point. */
struct neph_vec3 neph_bounds_nearest(const struct neph_bounds *box, struct neph_vec3 point_m);

/* The corner that is farthest from a point. */
struct neph_vec3 neph_bounds_farthest(const struct neph_bounds *box, struct neph_vec3 point_m);

/* Both corners moved; infinite sides stay. */
struct neph_bounds neph_bounds_moved(struct neph_bounds bounds, struct neph_vec3 by_m);

/* The box around a ball. */
struct neph_bounds neph_bounds_around(struct neph_vec3 center_m, double radius_m);

#endif

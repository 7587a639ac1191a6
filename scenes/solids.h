/* SPDX-License-Identifier: MIT
 *
 * Opaque solids: nearest hit, sun visibility, and the exact shadow a solid casts on a ray.
 */
#ifndef NEPH_SCENES_SOLIDS_H
#define NEPH_SCENES_SOLIDS_H

#include "scenes/scene.h"

struct neph_hit {
    double t_m;              /* distance along the unit direction; +inf when nothing is hit */
    struct neph_vec3 normal; /* unit, outward */
    const struct neph_solid *solid; /* NULL when nothing is hit */
};

/* Nearest solid with t > 0. A ray that starts inside a solid hits its far side. */
struct neph_hit neph_scene_hit(const struct neph_scene *scene, struct neph_vec3 origin_m,
                               struct neph_vec3 direction);

/* The point of a hit, moved off its surface by more than its rounding error, at any scale of the
 * world. */
struct neph_vec3 neph_hit_outside_m(const struct neph_hit *hit, struct neph_vec3 point_m);

/* Faces belong to the solid. */
bool neph_solid_contains(const struct neph_solid *solid, struct neph_vec3 point_m);

/* A box around the solid. */
struct neph_bounds neph_solid_bounds(const struct neph_solid *solid);

/* A point relative to the centre of a box, and a direction, in the axes of the unrotated box. */
struct neph_vec3 neph_box_place_m(const struct neph_solid *box, struct neph_vec3 point_m);
struct neph_vec3 neph_box_direction(const struct neph_solid *box, struct neph_vec3 direction);

/* Rotates a vector, and rotates it back. */
struct neph_vec3 neph_rotate(const struct neph_turn *turn, struct neph_vec3 vector);
struct neph_vec3 neph_rotate_back(const struct neph_turn *turn, struct neph_vec3 vector);

/* Whether there is a rotation. */
static inline bool neph_is_turned(const struct neph_turn *turn)
{
    return turn->cosine != 0.0 || turn->sine != 0.0;
}

/* True when no solid is between the point and the sun. */
bool neph_scene_is_sun_visible(const struct neph_scene *scene, struct neph_vec3 point_m);

/* True when no solid is between the point and another point, which is outside all solids. */
bool neph_scene_is_visible(const struct neph_scene *scene, struct neph_vec3 point_m,
                           struct neph_vec3 other_m);

/* neph_solid_shadow() for a point light. */
bool neph_solid_point_shadow(const struct neph_solid *solid, struct neph_vec3 light_m,
                             struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                             double t1_m, double *shadow_t0_m, double *shadow_t1_m);

/* The interval of t in [t0_m, t1_m] on which the sun is hidden by this solid from the points
 * origin + t direction. Both solids are convex, so there is one interval; false when none. */
bool neph_solid_shadow(const struct neph_solid *solid, struct neph_vec3 sun_direction,
                       struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                       double t1_m, double *shadow_t0_m, double *shadow_t1_m);

#endif

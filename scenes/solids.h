/* SPDX-License-Identifier: MIT
 *
 * Opaque solids: nearest hit, sun visibility, and the exact shadow a solid casts on a ray.
 */
#ifndef NEPH_SCENES_SOLIDS_H
#define NEPH_SCENES_SOLIDS_H

#include "scenes/box_tree.h"
#include "scenes/mesh_material.h"
#include "scenes/scene.h"
#include "scenes/shadows.h"

struct neph_hit {
    double t_m;               /* distance along the unit direction; +inf when nothing is hit */
    struct neph_vec3 normal;  /* unit, outward */
    struct neph_vec3 shading; /* unit, for the cosine law; of a smooth mesh not the normal */
    const struct neph_solid *solid; /* NULL when nothing is hit */
    double plane_m;               /* of a mesh: the triangle's plane has normal . point = plane_m */
    struct neph_mesh_place place; /* of a mesh */
};

/* The cosine of the law of Lambert for light from a direction, below or at 0: none. Light from
 * behind the surface counts as 0, even where the shading normal of a smooth mesh sees it. */
static inline double neph_hit_cosine(const struct neph_hit *hit, struct neph_vec3 direction)
{
    return neph_vec3_dot(hit->normal, direction) > 0.0 ? neph_vec3_dot(hit->shading, direction)
                                                       : 0.0;
}

/* A solid's bounds in a tree let rays skip it. The tree is built in a block of memory of this many
 * bytes, in which it stays; it is valid until a solid moves. 0: so few solids that each is tested.
 * The hit or shadow of a ray does not depend on the tree. */
size_t neph_scene_tree_bytes(int solid_count);
struct neph_box_tree *neph_scene_tree_build(const struct neph_solid *solids, int solid_count,
                                            void *memory);

/* Nearest solid with t > 0; of several at the same distance the first. A ray that starts inside a
 * solid hits its far side. The normal of a mesh is on the side of the ray. */
struct neph_hit neph_scene_hit(const struct neph_scene *scene, struct neph_vec3 origin_m,
                               struct neph_vec3 direction);

/* The point of a hit, moved off its surface by more than its rounding error, at any scale of the
 * world. A triangle does not hide the point of its hit from its side. */
struct neph_vec3 neph_hit_outside_m(const struct neph_hit *hit, struct neph_vec3 point_m);

/* Faces belong to a box or a sphere. No point is in a mesh with a boundary. */
bool neph_solid_contains(const struct neph_solid *solid, struct neph_vec3 point_m);

/* A box around the solid. */
struct neph_bounds neph_solid_bounds(const struct neph_solid *solid);

/* A point relative to the centre of a box, and a direction, in the axes of the unrotated box. */
struct neph_vec3 neph_box_place_m(const struct neph_solid *box, struct neph_vec3 point_m);
struct neph_vec3 neph_box_direction(const struct neph_solid *box, struct neph_vec3 direction);

/* The box, along the axes of the world, around a box that is rotated about its middle. */
struct neph_bounds neph_turned_box_bounds(const struct neph_bounds *box,
                                          const struct neph_turn *turn);

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

/* Adds the parts of the ray from which the light is hidden by one solid, or by any solid. */
void neph_solid_add_shadows(const struct neph_solid *solid, const struct neph_shadow_ray *ray,
                            struct neph_shadows *shadows);
void neph_scene_add_shadows(const struct neph_scene *scene, const struct neph_shadow_ray *ray,
                            struct neph_shadows *shadows);

/* neph_solid_shadow() for a point light. */
bool neph_solid_point_shadow(const struct neph_solid *solid, struct neph_vec3 light_m,
                             struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                             double t1_m, double *shadow_t0_m, double *shadow_t1_m);

/* The interval of t in [t0_m, t1_m] on which the sun is hidden by this solid from the points
 * origin + t direction. A box and a sphere are convex, so there is one interval; false when none.
 * Not for a mesh. */
bool neph_solid_shadow(const struct neph_solid *solid, struct neph_vec3 sun_direction,
                       struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                       double t1_m, double *shadow_t0_m, double *shadow_t1_m);

#endif

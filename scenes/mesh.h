/* SPDX-License-Identifier: MIT
 *
 * Triangle meshes for rays: nearest hit, any hit, and the shadows on a ray.
 *
 * Rays meet triangles by S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT
 * 2(1), 2013, in double: no ray passes between triangles with a common edge or vertex. An edge
 * belongs to all of its triangles. The nearest triangle is hit; of several at the same distance the
 * first of the file. Triangles have two sides; the normal of a hit is the side of the ray. The
 * distance is that of the triangle's plane, so that a point beside this plane never sees the
 * triangle on its other side. Where the material cuts it out, a triangle is not hit.
 *
 * All coordinates are the mesh's own; t is in units of the direction, which has any length > 0.
 */
#ifndef NEPH_SCENES_MESH_H
#define NEPH_SCENES_MESH_H

#include "base/hash.h"
#include "scenes/box_tree.h"
#include "scenes/mesh_material.h"
#include "scenes/shadows.h"

#include <stdint.h>

#define NEPH_MESH_FAR 1e9 /* largest coordinate */

/* A point may be inside a mesh without boundary. */
enum neph_mesh_inside {
    NEPH_MESH_OPEN,     /* it has a boundary: no point is inside */
    NEPH_MESH_EVEN,     /* inside: an odd number of triangles on a way to infinity */
    NEPH_MESH_ORIENTED, /* all triangles agree on the outside; inside: more ways out than in */
    NEPH_MESH_INSIDE_COUNT,
};

/* Immutable once its material is set; rays of several threads may use it. */
struct neph_mesh {
    struct neph_mesh_data data; /* triangles in the tree's order, without degenerate ones */
    int *number;                /* of each triangle: its index in the file */
    int dropped_count;          /* degenerate triangles: lower than 1e-14 of their longest side */
    struct neph_box_tree tree;
    enum neph_mesh_inside inside;
    char hash[NEPH_HASH_HEX_SIZE]; /* of the data as they were given */
    struct neph_mesh_material material;
};

struct neph_mesh_hit {
    double t;                     /* +inf: none */
    struct neph_mesh_place place; /* its triangle in the tree's order */
    struct neph_vec3 normal;      /* unit, geometric, towards the ray's origin */
};

/* Checks the data, drops degenerate triangles and builds the tree. Takes over the arrays of `data`
 * and clears it, also on errors. NEPH_ERR_INPUT: no triangle, too many, none with an area, a vertex
 * that is not finite or beyond NEPH_MESH_FAR, an index out of range, a normal of length 0. Free
 * with neph_mesh_destroy(). */
enum neph_status neph_mesh_create(struct neph_mesh_data *data, struct neph_mesh **mesh,
                                  struct neph_diag *diag);
void neph_mesh_destroy(struct neph_mesh *mesh);

/* The nearest hit with 0 < t < limit. `draw`: see coverage_draw in scenes/scene.h. */
struct neph_mesh_hit neph_mesh_meet(const struct neph_mesh *mesh, struct neph_vec3 origin,
                                    struct neph_vec3 direction, double limit, uint64_t draw);

/* Whether any triangle is hit with t_min < t < limit. */
bool neph_mesh_blocks(const struct neph_mesh *mesh, struct neph_vec3 origin,
                      struct neph_vec3 direction, double t_min, double limit, uint64_t draw);

/* Adds the parts of the ray from which the mesh hides the light. The shadow of a triangle is
 * convex, so each triangle adds one interval of t. A triangle that the light grazes edge on has no
 * shadow. Triangles are taken as whole, whatever their alpha is. */
void neph_mesh_add_shadows(const struct neph_mesh *mesh, const struct neph_shadow_ray *ray,
                           struct neph_shadows *shadows);

bool neph_mesh_contains(const struct neph_mesh *mesh, struct neph_vec3 point);

/* The normal of a triangle, unit, counterclockwise. */
struct neph_vec3 neph_mesh_normal(const struct neph_mesh *mesh, int triangle);

#endif

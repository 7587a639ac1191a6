/* SPDX-License-Identifier: MIT
 *
 * A bounding volume hierarchy over boxes: of the triangles of a mesh, or of the solids of a scene.
 * It is binary and built by the surface area heuristic with bins (I. Wald, "On fast Construction of
 * SAH-based Bounding Volume Hierarchies", IRT 2007). It only skips items whose boxes cannot be
 * met: a walk visits every item that its caller's test would accept.
 */
#ifndef NEPH_SCENES_BOX_TREE_H
#define NEPH_SCENES_BOX_TREE_H

#include "scenes/scene.h"

struct neph_tree_node {
    struct neph_bounds bounds;
    int first; /* of its items, as places in `order`; without items: its first child, the second
                  follows */
    int count; /* of its items; 0: it has children */
};

struct neph_box_tree {
    struct neph_tree_node *nodes; /* the first is the root */
    int *order;                   /* the items, such that those of a node follow each other */
    int node_count, item_count;
    double reach_m; /* the largest coordinate of the root, as an absolute value */
};

/* The number of nodes that a tree of `count` > 0 items may need. */
static inline int neph_box_tree_room(int count)
{
    return 2 * count - 1;
}

/* Builds the tree of finite boxes in the caller's memory: `nodes` has neph_box_tree_room(count)
 * places, `order` has `count`. Takes n log n steps. */
struct neph_box_tree neph_box_tree_build(const struct neph_bounds *boxes, int count,
                                         struct neph_tree_node *nodes, int *order);

/* A walk along a ray: nearer boxes first, for t between t_min_m and limit_m. */
struct neph_tree_ray {
    struct neph_vec3 origin_m, direction; /* of any length > 0; t is in units of it */
    double t_min_m, limit_m;              /* a visit may lower the limit */
};

/* Receives a place in `order`; true ends the walk. */
typedef bool neph_tree_visit(int place, void *context);

/* Visits all items whose box the ray may meet. Returns whether a visit ended the walk. */
bool neph_tree_walk_ray(const struct neph_box_tree *tree, const struct neph_tree_ray *ray,
                        neph_tree_visit *visit, void *context);

/* A view ray from whose points a light is hidden. */
struct neph_shadow_ray {
    struct neph_vec3 origin_m, direction; /* as above */
    struct neph_vec3 sun;                 /* towards it */
    const struct neph_vec3 *light_m;      /* a point light instead of the sun; NULL: the sun */
    double t0_m, t1_m;                    /* the part of the ray */
};

struct neph_shadows; /* scenes/shadows.h */

/* Visits all items whose box may hide the light from a point of the ray that is not in `known`
 * shadows, which visits may extend. */
void neph_tree_walk_shadow(const struct neph_box_tree *tree, const struct neph_shadow_ray *ray,
                           const struct neph_shadows *known, neph_tree_visit *visit, void *context);

#endif

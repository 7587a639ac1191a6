/* SPDX-License-Identifier: MIT
 *
 * The look of a mesh's triangles: the normal that light is reflected by, the colour, and where
 * texels let rays through.
 */
#ifndef NEPH_SCENES_MESH_MATERIAL_H
#define NEPH_SCENES_MESH_MATERIAL_H

#include "scenes/albedo_texture.h"
#include "scenes/mesh_data.h"

/* The alpha of a texture, bilinear as its colour is. */
enum neph_alpha {
    NEPH_ALPHA_IGNORED,
    NEPH_ALPHA_CUTOUT,   /* below 1/2 there is no surface, for any ray */
    NEPH_ALPHA_COVERAGE, /* the part of rays that meet the surface, each time */
    NEPH_ALPHA_COUNT,
};

/* Zero: flat, one colour. */
struct neph_mesh_material {
    bool is_smooth;                      /* the data have normals */
    enum neph_alpha alpha;               /* not IGNORED: the texture has alpha */
    struct neph_albedo_texture *texture; /* NULL: none; else the data have uv; owned by the mesh */
};

/* A point of a triangle. */
struct neph_mesh_place {
    int triangle;
    double weights[3]; /* of its corners; their sum is 1 */
};

/* The normal for the cosine law, unit: of a smooth mesh between those of the corners, on the side
 * of `normal`, which is the triangle's on the side of the ray. Light from the other side of the
 * triangle does not reach it, whatever this normal is. */
struct neph_vec3 neph_mesh_shading_normal(const struct neph_mesh_material *material,
                                          const struct neph_mesh_data *data,
                                          const struct neph_mesh_place *place,
                                          struct neph_vec3 normal);

/* The texture; white without one. */
struct neph_rgb neph_mesh_color(const struct neph_mesh_material *material,
                                const struct neph_mesh_data *data,
                                const struct neph_mesh_place *place);

/* The alpha of the texture, 0..1. */
double neph_mesh_alpha(const struct neph_mesh_material *material, const struct neph_mesh_data *data,
                       const struct neph_mesh_place *place);

#endif

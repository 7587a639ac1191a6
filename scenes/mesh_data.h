/* SPDX-License-Identifier: MIT
 *
 * A triangle mesh as a file or a generator gives it: vertices and triangles, unchecked. A sealed
 * mesh (scenes/mesh.h) is made from it.
 */
#ifndef NEPH_SCENES_MESH_DATA_H
#define NEPH_SCENES_MESH_DATA_H

#include "base/vec3.h"

enum {
    NEPH_MESH_TRIANGLES_MAX = 1000000,
    NEPH_MESH_VERTICES_MAX = 3 * NEPH_MESH_TRIANGLES_MAX, /* no triangle shares a vertex */
};

/* Zero-initialise it. All arrays are from malloc() and owned. Lengths and axes are the file's. */
struct neph_mesh_data {
    int vertex_count; /* <= NEPH_MESH_VERTICES_MAX */
    struct neph_vec3 *positions;
    int triangle_count;        /* <= NEPH_MESH_TRIANGLES_MAX */
    int (*triangles)[3];       /* 0-based vertices, counterclockwise seen from outside */
    struct neph_vec3 *normals; /* one per vertex, any length > 0; NULL: flat triangles */
    float (*uv)[2];            /* one per vertex, v up (0 is the image's lowest row); NULL: none */
};

/* Frees the arrays and clears the struct. Zero-initialised data are fine. */
void neph_mesh_data_finish(struct neph_mesh_data *data);

#endif

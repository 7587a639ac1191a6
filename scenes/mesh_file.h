/* SPDX-License-Identifier: MIT
 *
 * Triangle meshes from files: Wavefront OBJ (.obj), PLY (.ply) and glTF 2.0 (.gltf, .glb).
 */
#ifndef NEPH_SCENES_MESH_FILE_H
#define NEPH_SCENES_MESH_FILE_H

#include "base/status.h"
#include "scenes/mesh_data.h"

#include <stddef.h>

struct neph_mesh_request {
    const char *path;   /* to open */
    const char *shown;  /* the path as messages name it; NULL: `path` */
    const char *object; /* read only this object (OBJ: o or g; glTF: node); NULL: all */
    size_t limit_bytes; /* of memory for the file and the mesh */
};

/* Reads the triangles of a file. Polygons become fans of triangles. NEPH_ERR_INPUT: damaged, empty,
 * too large, of another kind, or without such an object; NEPH_ERR_NOT_FOUND, NEPH_ERR_IO,
 * NEPH_ERR_MEMORY. Numbers are finite and indices in range on success. */
enum neph_status neph_mesh_read(const struct neph_mesh_request *request,
                                struct neph_mesh_data *data, struct neph_diag *diag);

#endif

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
    const char *object; /* o or g of OBJ; node, with those below, or mesh of glTF; NULL: all */
    size_t limit_bytes; /* for the file, for the buffers of a .gltf, and for the mesh, each */
};

/* Reads the triangles of a file.
 *
 * ssimp reads it in the program neph-mesh (scenes/mesh_program.h), in float32: refused if that
 * moves vertices by more than 1e-4 of the size. Polygons are cut into triangles between their
 * corners, concave ones by ear clipping; lines and points are left out. Nodes of glTF are placed
 * by their transforms, and mirrored ones keep their outside; skins and morphs are not applied.
 * Vertices that are equal in all bits become one. Normals (of length 1) and uv are kept where each
 * vertex has them. Open, self-intersecting and non-manifold meshes are read as they are.
 *
 * No file is opened outside of the folder of `path`, links followed, and inside it only the buffers
 * of glTF: no materials and no textures.
 *
 * NEPH_ERR_INPUT: damaged, empty, too large, of another kind, without such an object, or it names
 * buffers outside of its folder. NEPH_ERR_UNAVAILABLE: neph was built without Assimp. Also
 * NEPH_ERR_NOT_FOUND, NEPH_ERR_IO, NEPH_ERR_MEMORY. Each message names the file. */
enum neph_status neph_mesh_read(const struct neph_mesh_request *request,
                                struct neph_mesh_data *data, struct neph_diag *diag);

/* The mesh in the output of neph-mesh, whatever that contains: on success numbers are finite and
 * indices in range. NEPH_ERR_INPUT, NEPH_ERR_MEMORY. */
enum neph_status neph_mesh_take(const void *bytes, size_t size, struct neph_mesh_data *data,
                                struct neph_diag *diag);

/* The path of neph-mesh, from NEPH_MESH or beside the running program; the caller frees it.
 * NEPH_ERR_UNAVAILABLE: no such program. */
enum neph_status neph_mesh_find_program(char **program, struct neph_diag *diag);

#endif

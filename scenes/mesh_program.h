/* SPDX-License-Identifier: MIT
 *
 * The protocol between neph and the program neph-mesh, which alone links Assimp; it is built where
 * that library is. As OpenVDB (volume_vdb.h), Assimp trusts its files, so the program runs with
 * limits on memory, time and written bytes, and neph checks all of its output:
 *     neph-mesh read MESH FILE LIMIT_BYTES CPU_LIMIT_S TRIANGLES_MAX [OBJECT]
 *
 * MESH is memory of neph, as for neph-vdb. It receives a header, then for each vertex a struct
 * neph_mesh_corner, no two of which are equal, then for each triangle three vertices as int32.
 * LIMIT_BYTES is for FILE and for MESH, each.
 *
 * The program opens FILE, and the buffers that a glTF file names if they are below its folder after
 * links were followed. It opens no other file: no materials, no pictures.
 *
 * Exit codes and the reason of a failure: as those of neph-vdb.
 */
#ifndef NEPH_SCENES_MESH_PROGRAM_H
#define NEPH_SCENES_MESH_PROGRAM_H

#include <stdint.h>

struct neph_mesh_header {
    int64_t vertex_count, triangle_count;
    int64_t has_normals, has_uv; /* else they are 0 */
};

struct neph_mesh_corner {
    double position[3], normal[3];
    float uv[2];
};

#endif

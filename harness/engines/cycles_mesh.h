/* SPDX-License-Identifier: MIT
 *
 * The meshes of a scene for Blender: a file for each beside the spec, and a member of the spec for
 * each of its solids.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_MESH_H
#define NEPH_HARNESS_ENGINES_CYCLES_MESH_H

#include "harness/json.h"
#include "scenes/scene.h"

/* Writes the files into a folder: (x, -z, y) of each vertex as float32, each triangle as three
 * int32, of a smooth mesh the normals as the vertices, with a texture (u, v) of each vertex as
 * float32, all in the machine's order of bytes; for each texture linear R G B alpha of each pixel
 * as float32, rows from the bottom. NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_cycles_write_meshes(const struct neph_scene *scene, const char *directory,
                                          struct neph_diag *diag);

/* The shape of a solid that is a mesh, a new reference: file, counts, texture, the mesh's unit
 * vectors in the world times scale_m, the place of its origin. NULL: a number is not finite. */
json_t *neph_cycles_mesh(const struct neph_scene *scene, const struct neph_solid *solid);

#endif

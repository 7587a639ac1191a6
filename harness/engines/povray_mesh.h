/* SPDX-License-Identifier: MIT
 *
 * The meshes of a scene for POV-Ray: an include file for each, which declares it, and an object for
 * each of its solids. The triangles of a mesh have no inside, which only POV-Ray's CSG would need.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_MESH_H
#define NEPH_HARNESS_ENGINES_POVRAY_MESH_H

#include "harness/engines/povray_text.h"

/* Writes the include files into a folder. NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_povray_put_meshes(const struct neph_povray_world *world,
                                        const char *directory, struct neph_diag *diag);

/* The includes of the scene's text, and a solid's object without its closing brace. */
void neph_povray_include_meshes(struct neph_povray_writer *writer);
void neph_povray_write_mesh(struct neph_povray_writer *writer, const struct neph_solid *solid);

#endif

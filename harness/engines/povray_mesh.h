/* SPDX-License-Identifier: MIT
 *
 * The meshes of a scene for POV-Ray: an include file for each, which declares it, and an object for
 * each of its solids; images for its texture. The triangles of a mesh have no inside, which only
 * POV-Ray's CSG would need.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_MESH_H
#define NEPH_HARNESS_ENGINES_POVRAY_MESH_H

#include "harness/engines/povray_text.h"

/* Writes the include files and images into a folder. NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_povray_put_meshes(const struct neph_povray_world *world,
                                        const char *directory, struct neph_diag *diag);

/* The includes of the scene's text, and a solid's object without its closing brace. */
void neph_povray_include_meshes(struct neph_povray_writer *writer);
void neph_povray_write_mesh(struct neph_povray_writer *writer, const struct neph_solid *solid);

/* The pigment of a solid whose mesh has a texture, in this image's colours; its mesh's images have
 * the albedo, too. */
void neph_povray_write_mesh_pigment(struct neph_povray_writer *writer,
                                    const struct neph_solid *solid);

/* The pattern of a mesh's alpha; the start and the end of the texture of a solid whose mesh is cut
 * out: in between is the texture of the rest, whose functions have uv for x and y. */
void neph_povray_write_alpha(struct neph_povray_writer *writer, const struct neph_solid *solid);
void neph_povray_start_cutout(struct neph_povray_writer *writer, const struct neph_solid *solid);
void neph_povray_end_cutout(struct neph_povray_writer *writer);

#endif

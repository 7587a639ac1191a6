/* SPDX-License-Identifier: MIT
 *
 * The solids of a scene for POV-Ray: shapes, finishes, and the texture that shows depth.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_SOLIDS_H
#define NEPH_HARNESS_ENGINES_POVRAY_SOLIDS_H

#include "harness/engines/povray_text.h"
#include "scenes/grid.h"

void neph_povray_write_solids(struct neph_povray_writer *writer);

/* The noise of a seed (scenes/surface.h) as a density file, and the file's name: one layer of nodes
 * at integer positions, periodic (the last node repeats the first). For neph_grid_destroy(). */
void neph_povray_noise_name(int seed, char name[NEPH_POVRAY_FILE_NAME_MAX]);
enum neph_status neph_povray_noise(int seed, struct neph_grid **grid, struct neph_diag *diag);

#endif

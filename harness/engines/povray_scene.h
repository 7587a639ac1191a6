/* SPDX-License-Identifier: MIT
 *
 * Scenes as POV-Ray 3.7 text. The text consists of fixed words and numbers only: no string of a
 * scene enters it, so a scene cannot make POV-Ray do anything but render.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_SCENE_H
#define NEPH_HARNESS_ENGINES_POVRAY_SCENE_H

#include "harness/engines/povray_pass.h"
#include "harness/engines/povray_world.h"
#include "scenes/grid.h"

#include <stdbool.h>

/* POV-Ray's media abort above this number ("internal nesting limit"). */
#define NEPH_POVRAY_INTERVALS_MAX 256

/* The number of precomputed radiosity directions in POV-Ray. */
#define NEPH_POVRAY_RAYS_MAX 1600

/* Make the text of one pass, for the caller to free. */
enum neph_status neph_povray_text(const struct neph_povray_world *world,
                                  const struct neph_povray_pass *pass, char **text,
                                  struct neph_diag *diag);

/* The name of the density file of a grid medium, beside the text; `index`: the medium's index in
 * the scene. */
void neph_povray_grid_name(int index, char name[NEPH_POVRAY_FILE_NAME_MAX]);

/* The grid for that file. Its largest density stays below full scale, where POV-Ray's patterns wrap
 * to 0. The result shares the values of `grid`. */
struct neph_grid neph_povray_grid(const struct neph_grid *grid);

/* Whether POV-Ray has a phase function. */
bool neph_povray_has_phase(enum neph_phase_kind kind);

/* The ratio of POV-Ray's phase factor to 4 pi p, for a supported phase function. */
double neph_povray_phase_excess(enum neph_phase_kind kind);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Phase functions as nodes Volume Scatter of Blender, whose sum a medium's material has.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_PHASE_H
#define NEPH_HARNESS_ENGINES_CYCLES_PHASE_H

#include "base/status.h"
#include "harness/json.h"
#include "scenes/scene.h"

/* NEPH_ERR_UNSUPPORTED, with the reason: a medium's phase function that no Cycles has, or media of
 * different ones where their containers overlap. */
enum neph_status neph_cycles_check_phases(const struct neph_scene *scene,
                                          const struct neph_bounds *containers,
                                          struct neph_diag *diag);

/* The nodes: an array of objects with `phase`, `share` of the scattering and `inputs`, for
 * json_decref() by the caller; empty: no Cycles has that phase function. */
json_t *neph_cycles_lobes(const struct neph_phase *phase);

bool neph_cycles_has_extinction(const struct neph_medium *medium);

/* Whether a medium has another phase function than one Henyey-Greenstein. Blender has the others
 * from 4.3 on. Two lobes are two nodes; Blender 3.4 adds their direct light up without weights,
 * 1.5 to 3 times too bright. */
bool neph_cycles_needs_phases(const struct neph_scene *scene);

#endif

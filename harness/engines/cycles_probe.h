/* SPDX-License-Identifier: MIT
 *
 * Finds the features of a Blender by rendering a trial scene (trial.h).
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_PROBE_H
#define NEPH_HARNESS_ENGINES_CYCLES_PROBE_H

#include "base/status.h"

#include <stdbool.h>

struct neph_cycles_features {
    bool has_voxels;   /* renders media from OpenVDB files */
    bool has_unbiased; /* has unbiased volume rendering without steps, which is its default */
    bool has_phases;   /* has all phase functions of cycles_phase.h, and weights their sums */
    bool has_spots;    /* its version's falloff inside a spot's cone is known */
};

/* Find the features of Blender `program` (index, blender.h). A result is cached in the cache folder
 * (trial.h), a failure is not. NEPH_ERR_UNAVAILABLE: no such program. NEPH_ERR_ENGINE, with the
 * reason: no images, black images, or wrong values. */
enum neph_status neph_cycles_features(int program, struct neph_cycles_features *features,
                                      struct neph_diag *diag);

#endif

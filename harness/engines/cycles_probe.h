/* SPDX-License-Identifier: MIT
 *
 * What a Blender can do, by a trial (trial.h).
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_PROBE_H
#define NEPH_HARNESS_ENGINES_CYCLES_PROBE_H

#include "base/status.h"

#include <stdbool.h>

struct neph_cycles_features {
    bool has_voxels;   /* media from OpenVDB files are in its images */
    bool has_unbiased; /* volumes without steps, which it draws unless told otherwise */
    bool has_rayleigh; /* the phase function */
    bool has_spots;    /* the law by which light falls off in a spot is known of its version */
};

/* Find the features of Blender `program` (blender.h). The result is kept in the cache folder
 * (trial.h), a failure is not. NEPH_ERR_UNAVAILABLE: no such program. NEPH_ERR_ENGINE: it does not
 * render what neph needs, and why: no images, black ones, or values that are not those of the
 * scene. */
enum neph_status neph_cycles_features(int program, struct neph_cycles_features *features,
                                      struct neph_diag *diag);

#endif

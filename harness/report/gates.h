/* SPDX-License-Identifier: MIT
 *
 * The limits of a scene file against what was measured. A frame that they do not name is limited,
 * too: the means of its radiance and its transmittance are to be within a factor of two of those of
 * the truth. So an engine that is far off does not pass for want of a gate.
 */
#ifndef NEPH_HARNESS_REPORT_GATES_H
#define NEPH_HARNESS_REPORT_GATES_H

#include "harness/report/validation.h"

/* Judge the gates of a scene whose frames are measured: result->gates, in the arena. A frame that
 * no gate of the scene limits has one there when it fails. */
void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result);

#endif

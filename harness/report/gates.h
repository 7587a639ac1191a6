/* SPDX-License-Identifier: MIT
 *
 * The limits of a scene file against what was measured.
 */
#ifndef NEPH_HARNESS_REPORT_GATES_H
#define NEPH_HARNESS_REPORT_GATES_H

#include "harness/report/validation.h"

/* Judge the gates of a scene whose frames are measured: result->gates, in the arena. */
void neph_gates_judge(const struct neph_scene *scene, struct neph_arena *arena,
                      struct neph_scene_result *result);

#endif

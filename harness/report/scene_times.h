/* SPDX-License-Identifier: MIT
 *
 * How long engines take for the frames of a scene, by one definition for all of them
 * (harness/run/speed.h). Measured when no worker process renders.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_TIMES_H
#define NEPH_HARNESS_REPORT_SCENE_TIMES_H

#include "harness/report/scene_run.h"

/* Fill in the speeds of all frames that were rendered. The scene is that of the result. */
enum neph_status neph_scene_times(const struct neph_scene_run *run, const struct neph_scene *scene,
                                  struct neph_scene_result *result, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Frame times of all engines for a scene, by one definition (harness/run/speed.h). Measured while
 * no worker process renders.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_TIMES_H
#define NEPH_HARNESS_REPORT_SCENE_TIMES_H

#include "harness/report/scene_run.h"

/* Set the speeds of all rendered frames. `scene` is the scene of the result. */
enum neph_status neph_scene_times(const struct neph_scene_run *run, const struct neph_scene *scene,
                                  struct neph_scene_result *result, struct neph_diag *diag);

#endif

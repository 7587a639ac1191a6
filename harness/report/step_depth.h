/* SPDX-License-Identifier: MIT
 *
 * The largest optical depth of a single step of a ray marcher. A midpoint rule does not resolve
 * changes within a step. Above an optical depth of 1 it loses light without a visible artefact.
 */
#ifndef NEPH_HARNESS_REPORT_STEP_DEPTH_H
#define NEPH_HARNESS_REPORT_STEP_DEPTH_H

#include "harness/engines/engine.h"

/* A larger optical depth of a step causes a warning. */
#define NEPH_STEP_DEPTH_MAX 1.0

/* The largest optical depth, in any channel, of a step on the view rays of a shot up to an optical
 * depth of 4. Evaluated on 32 x 18 rays, at most 64 points each. NaN for engines without a fixed
 * number of steps and when memory is short. */
double neph_step_depth(const struct neph_shot *shot, const struct neph_engine *engine);

/* The warning with a remedy, to be freed by the caller; NULL: no warning, or memory is short. */
char *neph_step_depth_warning(double depth, const struct neph_engine *engine);

#endif

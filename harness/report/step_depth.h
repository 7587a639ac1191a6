/* SPDX-License-Identifier: MIT
 *
 * How much optical depth one step of a ray marcher spans. A midpoint rule knows nothing of what
 * happens within a step: above 1 it misses the light, and no picture shows that.
 */
#ifndef NEPH_HARNESS_REPORT_STEP_DEPTH_H
#define NEPH_HARNESS_REPORT_STEP_DEPTH_H

#include "harness/engines/engine.h"

/* Above this a frame's steps are too long to trust. */
#define NEPH_STEP_DEPTH_MAX 1.0

/* The largest optical depth, in any channel, of a step that the engine takes on the view rays of a
 * shot before these are opaque: found on 32 x 18 of them, at 64 places at most of each. NaN for
 * engines whose steps are no fixed number to a ray, and without memory. */
double neph_step_depth(const struct neph_shot *shot, const struct neph_engine *engine);

/* What to say of it, in words and with the way out, for the caller to free; NULL when there is
 * nothing to say, or no memory. */
char *neph_step_depth_warning(double depth, const struct neph_engine *engine);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The tables of a sky as lines of what a picture in flight has cost.
 */
#ifndef NEPH_HARNESS_ENGINES_SKY_PASSES_H
#define NEPH_HARNESS_ENGINES_SKY_PASSES_H

#include "harness/engines/engine.h"
#include "renderer/sky/sky_times.h"

/* Add them behind the passes that are there, also those that nothing was filled of: a picture has
 * the passes of the others. */
void neph_sky_passes_add(const struct neph_sky_times *times, struct neph_flight_cost *cost);

#endif

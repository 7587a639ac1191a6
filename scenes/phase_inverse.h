/* SPDX-License-Identifier: MIT
 *
 * The inverse of the distribution of a phase function that has no closed one. Private to scenes/.
 */
#ifndef NEPH_SCENES_PHASE_INVERSE_H
#define NEPH_SCENES_PHASE_INVERSE_H

#include "scenes/phase.h"

/* The light scattered within versine v of straight ahead, 0..1. */
typedef double neph_phase_light(const struct neph_phase *phase, double v);

/* The versine for a uniform number u in (0, 1), within which the light is 1 - u. */
double neph_phase_invert(const struct neph_phase *phase, neph_phase_light *within, double u);

#endif

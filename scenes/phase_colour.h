/* SPDX-License-Identifier: MIT
 *
 * Phase functions that depend on the colour channel, which only tables do.
 */
#ifndef NEPH_SCENES_PHASE_COLOUR_H
#define NEPH_SCENES_PHASE_COLOUR_H

#include "base/vec3.h"
#include "scenes/phase.h"

/* True where the channels differ. The functions of scenes/phase.h are then those of their mean. */
bool neph_phase_is_coloured(const struct neph_phase *phase);

/* The phase function of channel 0, 1 or 2. */
struct neph_phase neph_phase_channel(const struct neph_phase *phase, int channel);

/* Values by channel [1/sr] for the cosine between the directions before and after. */
struct neph_rgb neph_phase_rgb_per_sr(const struct neph_phase *phase, double cosine);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Point lights and spots near the rays of pixels, for POV-Ray. It samples a ray through a medium at
 * equal steps, which miss the peak of 1/d^2 beside a light, and it loses the cone of a spot whose
 * apex is on the ray in the rounding of b^2 - a c (ComputeSpotLightInterval of its media.cpp: half
 * of the pixels black for a spot at the eye). So
 * - clear cubes around a light cut the rays that pass it near, in pieces that are as short as the
 *   light is near: each piece gets all intervals of the medium;
 * - a spot near the line of a pixel's ray is a light all around in a small cube that lets through
 *   what the spot's cone does.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_LAMPS_H
#define NEPH_HARNESS_ENGINES_POVRAY_LAMPS_H

#include "harness/engines/povray_world.h"

/* Fill in `world->lamps` for all pixels of the frame. NEPH_ERR_UNSUPPORTED, with the pixel and the
 * light, where a ray comes so near to a light within a medium that POV-Ray's numbers end. */
enum neph_status neph_povray_cut_rays(struct neph_povray_world *world, struct neph_diag *diag);

#endif

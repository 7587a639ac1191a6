/* SPDX-License-Identifier: MIT
 *
 * Point lights and spots near the rays of pixels, for POV-Ray. Two faults of POV-Ray are corrected:
 * - It samples a medium at equal steps, which miss the peak of 1/d^2 near a light. Clear cubes
 *   around a light cut the rays that pass near it into pieces that are shorter near the light; each
 *   piece gets all intervals of the medium.
 * - It loses the cone of a spot with its apex on the ray by rounding in b^2 - a c
 *   (ComputeSpotLightInterval of its media.cpp; half of the pixels are black for a spot at the
 *   eye). A spot near the line of a pixel's ray becomes a point light in a small cube, whose
 *   transparency has the angular falloff of the spot.
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_LAMPS_H
#define NEPH_HARNESS_ENGINES_POVRAY_LAMPS_H

#include "harness/engines/povray_world.h"

/* Set `world->lamps` for all pixels of the frame. NEPH_ERR_UNSUPPORTED, with pixel and light:
 * inside a medium, a ray passes a light so closely that POV-Ray's precision is insufficient. */
enum neph_status neph_povray_cut_rays(struct neph_povray_world *world, struct neph_diag *diag);

#endif

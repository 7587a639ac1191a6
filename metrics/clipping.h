/* SPDX-License-Identifier: MIT
 *
 * What a display does not show. A metric of display values sees white in all that is brighter than
 * white, so two pictures that differ there are alike to it: how much of them that is belongs beside
 * its number.
 */
#ifndef NEPH_METRICS_CLIPPING_H
#define NEPH_METRICS_CLIPPING_H

#include "metrics/extractor.h"
#include "metrics/mask.h"

/* Counts of one quantity over the masks, of a frame and of all frames so far. */
struct neph_clipping;

/* In the arena; NULL when memory is short. */
struct neph_clipping *neph_clipping_create(int mask_count, struct neph_arena *memory);

/* Look at the next frame, of a quantity with three planes. `masks` are as many as at creation. */
void neph_clipping_look(struct neph_clipping *clipping, const struct neph_frame_pair *pair,
                        const struct neph_mask *const *masks);

/* The share of the pixels of a mask that are beyond the bound: of the last frame, or (`of_all`) of
 * all together. 0 for NEPH_BOUND_NONE and for a mask without pixels. */
struct neph_clipped neph_clipping_shares(const struct neph_clipping *clipping,
                                         enum neph_display_bound bound,
                                         const struct neph_mask *mask, int index, bool of_all);

/* Whether test and reference have an unequal value anywhere in the mask. */
bool neph_clipping_differs(const struct neph_clipping *clipping, int index, bool of_all);

#endif

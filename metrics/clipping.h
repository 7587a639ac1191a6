/* SPDX-License-Identifier: MIT
 *
 * Counts pixels that a display cannot show. A metric of display values sees everything above white
 * as white, so it misses differences there. The share of such pixels is printed beside its number.
 */
#ifndef NEPH_METRICS_CLIPPING_H
#define NEPH_METRICS_CLIPPING_H

#include "metrics/extractor.h"
#include "metrics/mask.h"

/* Counts for one quantity over the masks, of the last frame and of all frames so far. */
struct neph_clipping;

/* Allocated in the arena; NULL: memory is short. */
struct neph_clipping *neph_clipping_create(int mask_count, struct neph_arena *memory);

/* Count the next frame of a quantity with three planes. `masks`: as many as at creation. */
void neph_clipping_add_frame(struct neph_clipping *clipping, const struct neph_frame_pair *pair,
                             const struct neph_mask *const *masks);

/* Share of a mask's pixels that are beyond the bound, in the last frame or (`of_all`) in all
 * frames. 0 for NEPH_BOUND_NONE and for an empty mask. */
struct neph_clipped neph_clipping_shares(const struct neph_clipping *clipping,
                                         enum neph_display_bound bound,
                                         const struct neph_mask *mask, int index, bool of_all);

/* Whether test and reference differ anywhere in the mask. */
bool neph_clipping_differs(const struct neph_clipping *clipping, int index, bool of_all);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Sub-pixel jitter of a frame's rays, for temporal anti-aliasing.
 */
#ifndef NEPH_RENDERER_REALTIME_JITTER_H
#define NEPH_RENDERER_REALTIME_JITTER_H

#include <stdint.h>

/* Offset of a frame's rays from their pixels' centres [px]; x right, y down. The sequence repeats
 * after `length` >= 1 frames.
 *
 * kinds:
 * - RT_JITTER_NONE: 0.
 * - RT_JITTER_HALTON: the sequence of J. H. Halton (Numer. Math. 2, 1960), bases 2 and 3, minus
 *   0.5.
 * - RT_JITTER_UE: Unreal Engine 4.26. The same numbers, mapped to a Gaussian of sigma 0.47 px that
 *   is cut off at 0.5 px (G. E. P. Box, M. E. Muller, Ann. Math. Stat. 29, 1958). Unreal shifts the
 *   image by them, right and down; here they shift the rays, so the pattern is Unreal's rotated by
 *   180 degrees. */
void neph_rt_jitter(int kind, int length, uint32_t index, double offset_px[2]);

#endif

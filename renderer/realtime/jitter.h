/* SPDX-License-Identifier: MIT
 *
 * Sub-pixel places of a frame's rays, for temporal anti-aliasing to average.
 */
#ifndef NEPH_RENDERER_REALTIME_JITTER_H
#define NEPH_RENDERER_REALTIME_JITTER_H

#include <stdint.h>

/* Offset of the rays from their pixels' centres in the frame with this index [px]; x right, y down.
 * It repeats after `length` >= 1 frames.
 *
 * `kind`: RT_JITTER_NONE; RT_JITTER_HALTON, numbers of J. H. Halton (Numer. Math. 2, 1960, bases 2
 * and 3) less one half; RT_JITTER_UE, Unreal Engine 4.26: the same numbers made Gaussian, of 0.47
 * px, within 0.5 px (G. E. P. Box, M. E. Muller, Ann. Math. Stat. 29, 1958).
 *
 * Unreal's numbers say how far the picture moves, right and down, its rays the other way; here the
 * rays go by the same numbers: the pattern is Unreal's turned by half a circle. */
void neph_rt_jitter(int kind, int length, uint32_t index, double offset_px[2]);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Helpers of symmetric filters: images are mirrored at their borders, and two neighbours at the
 * same distance have the same weight.
 */
#ifndef NEPH_METRICS_MIRROR_H
#define NEPH_METRICS_MIRROR_H

/* The pixel at index `i` of the mirrored row; `i` may be any distance below 0 or above count -
 * 1. */
static inline int neph_mirrored(int i, int count)
{
    const int period = 2 * count, inside = (i % period + period) % period;
    return inside < count ? inside : period - 1 - inside;
}

/* Fill the `margin` values before and after row[0 .. count - 1]. */
void neph_mirror_margins(float *row, int count, int margin);

/* sums += weight * (before + after), by element. */
void neph_add_pairs(float *restrict sums, const float *before, const float *after, float weight,
                    int count);

#endif

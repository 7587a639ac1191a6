/* SPDX-License-Identifier: MIT
 *
 * What even filters share: pictures are mirrored at their borders, and two neighbours at the same
 * distance have the same weight.
 */
#ifndef NEPH_METRICS_MIRROR_H
#define NEPH_METRICS_MIRROR_H

/* The pixel that stands at `i`, before 0 or behind count - 1, too; as often as it takes. */
static inline int neph_mirrored(int i, int count)
{
    const int period = 2 * count, inside = (i % period + period) % period;
    return inside < count ? inside : period - 1 - inside;
}

/* Fill the `margin` values before and behind row[0 .. count - 1]. */
void neph_mirror_margins(float *row, int count, int margin);

/* sums += weight * (before + after), by element. */
void neph_add_pairs(float *restrict sums, const float *before, const float *after, float weight,
                    int count);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The smallest step of light for the lag metrics: the smallest that an 8-bit display can show.
 */
#ifndef NEPH_METRICS_EXTRACTORS_VISIBLE_STEP_H
#define NEPH_METRICS_EXTRACTORS_VISIBLE_STEP_H

#include <math.h>
#include <stdbool.h>

/* The sRGB curve (IEC 61966-2-1), extended above 1 so that a step beyond white counts, too. */
static inline double neph_encoded_display(double display)
{
    const double c = fmax(display, 0.0);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

/* Whether two linear values differ by more than 1/255 of the encoded range; `gain` converts them to
 * display values. */
static inline bool neph_is_visible_step(double from, double to, double gain)
{
    return fabs(neph_encoded_display(gain * from) - neph_encoded_display(gain * to)) > 1.0 / 255.0;
}

#endif

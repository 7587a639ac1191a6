/* SPDX-License-Identifier: MIT */
#include "scenes/phase_inverse.h"

#include <math.h>

/* By Newton's method between bounds. The first guess is that of a peak: the light at its top is
 * 2 pi times its value and the versine. */
double neph_phase_invert(const struct neph_phase *phase, neph_phase_light *within, double u)
{
    double low = 0.0, high = 2.0;
    double v = fmin(1.0, (1.0 - u) / (2.0 * M_PI * neph_phase_per_sr(phase, 1.0)));
    for (int i = 0; i < 200; i++) {
        const double excess = within(phase, v) - (1.0 - u);
        if (excess > 0.0)
            high = v;
        else
            low = v;
        const double next = v - excess / (2.0 * M_PI * neph_phase_per_sr(phase, 1.0 - v));
        const double kept = next > low && next < high ? next : 0.5 * (low + high);
        if (fabs(kept - v) <= 4e-16 * v)
            return kept;
        v = kept;
    }
    return v;
}

/* SPDX-License-Identifier: MIT */
#include "truth/moments.h"

#include <math.h>

void neph_moments_add(struct neph_moments *moments, double value)
{
    moments->first = moments->count > 0.0 ? moments->first : value;
    const double off = value - moments->first;
    moments->count += 1.0;
    moments->powers[0] += off;
    moments->powers[1] += off * off;
    moments->powers[2] += off * off * off;
    moments->powers[3] += off * off * off * off;
}

struct neph_moments_estimate neph_moments_estimate(const struct neph_moments *moments)
{
    const double n = moments->count;
    if (n < 2.0)
        return (struct neph_moments_estimate){n > 0.0 ? moments->first : NAN, NAN, NAN};
    const double m = moments->powers[0] / n, p2 = moments->powers[1] / n,
                 p3 = moments->powers[2] / n, p4 = moments->powers[3] / n;
    /* Values that differ by rounding have no variance. */
    const double least = 1e-26 * moments->first * moments->first;
    const double second = p2 - m * m > least ? p2 - m * m : 0.0,
                 fourth = fmax(second * second,
                               p4 - 4.0 * m * p3 + 6.0 * m * m * p2 - 3.0 * m * m * m * m);
    /* At least that of as many normal numbers. */
    const double least_doubt = 2.0 / (n - 1.0);
    const double doubt = second > 0.0 ? fmax(least_doubt, (fourth / (second * second) - 1.0) / n)
                                      : 0.0;
    return (struct neph_moments_estimate){moments->first + m, sqrt(second / (n - 1.0)), doubt};
}

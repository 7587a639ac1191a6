/* SPDX-License-Identifier: MIT */
#include "renderer/sky/harmonics.h"

#include <math.h>

/* sqrt((2 l + 1) / (4 pi) (l - m)! / (l + m)!), times sqrt 2 for m > 0 (cos(m phi)). */
double neph_sky_norm(int l, int m)
{
    double ratio = (2.0 * l + 1.0) / (4.0 * M_PI) * (m > 0 ? 2.0 : 1.0);
    for (int k = l - m + 1; k <= l + m; k++)
        ratio /= k;
    return sqrt(ratio);
}

void neph_sky_harmonics(int degree, double x, double z, double values[NEPH_SKY_MOMENTS_MAX])
{
    const double across2 = fmax(0.0, 1.0 - z * z); /* x^2 + y^2 */
    double wave = 1.0, before = 0.0;               /* Re (x + i y)^m, and for m - 1 */
    double start = 1.0;                            /* P_mm without its factor sine^m: (2 m - 1)!! */
    for (int m = 0; m <= degree; m++) {
        double legendre = start, lower = 0.0;
        for (int l = m; l <= degree; l++) {
            values[l * (l + 1) / 2 + m] = neph_sky_norm(l, m) * legendre * wave;
            const double next = ((2.0 * l + 1.0) * z * legendre - (l + m) * lower) / (l + 1.0 - m);
            lower = legendre;
            legendre = next;
        }
        const double next = m == 0 ? x : 2.0 * x * wave - across2 * before;
        before = wave;
        wave = next;
        start *= 2.0 * m + 1.0;
    }
}

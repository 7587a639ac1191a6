/* SPDX-License-Identifier: MIT */
#include "scenes/phase_povray.h"

#include <math.h>

/* The mean of x^n over the sphere is 1 / (n + 1). */
static double lobe_share(struct neph_haze haze)
{
    const double mean = haze.height / (haze.power + 1.0);
    return mean / (1.0 + mean);
}

double neph_haze_per_sr(struct neph_haze haze, double cosine)
{
    const double x = 0.5 * (1.0 + fmin(1.0, fmax(-1.0, cosine)));
    return (1.0 + haze.height * pow(x, haze.power)) * (1.0 - lobe_share(haze)) / (4.0 * M_PI);
}

/* The lobe has 1 - x^(n + 1) of its light there, the isotropic rest v / 2. */
double neph_haze_within(struct neph_haze haze, double v)
{
    const double share = lobe_share(haze);
    return (1.0 - share) * 0.5 * v - share * expm1((haze.power + 1.0) * log1p(-0.5 * v));
}

/* The mean of P_l over the lobe is the product of (n - k + 1) / (n + k + 1) for k = 1 to l. */
double neph_haze_moment(struct neph_haze haze, int degree)
{
    double moment = lobe_share(haze);
    for (int k = 1; k <= degree; k++)
        moment *= (haze.power - k + 1.0) / (haze.power + k + 1.0);
    return moment;
}

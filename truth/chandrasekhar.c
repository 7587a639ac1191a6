/* SPDX-License-Identifier: MIT
 *
 * The H function of isotropic scattering. In its integral
 *   ln H(mu) = -(mu / pi) int_0^{pi/2} ln(1 - w x cot x) / (cos^2 x + mu^2 sin^2 x) dx,
 * the substitution tan x = tan(a) / mu removes the peak at small mu:
 *   ln H(mu) = -(1 / pi) int_0^{pi/2} ln(1 - w x cot x) da.
 * For w = 1 the new integrand has a logarithmic singularity at a = 0; the double exponential rule
 * (Takahasi and Mori 1974) is not affected by it.
 */
#include "truth/slab.h"

#include <math.h>

/* ln(1 - w x cot x), without the cancellation at small x where 1 - x cot x = x^2/3 + x^4/45 + ...
 */
static double log_dispersion(double albedo, double x, double tangent)
{
    double rest; /* 1 - x cot x */
    if (x < 0.1) {
        const double s = x * x;
        rest = s * (1.0 / 3.0 +
                    s * (1.0 / 45.0 +
                         s * (2.0 / 945.0 + s * (1.0 / 4725.0 +
                                                 s * (2.0 / 93555.0 + s * 1382.0 / 638512875.0)))));
    } else {
        rest = 1.0 - x / tangent;
    }
    return log((1.0 - albedo) + albedo * rest);
}

/* The trapezoid rule in t with a = (pi/2) / (1 + e^(-pi sinh t)). */
static double double_exponential(double albedo, double cosine, double step)
{
    double sum = 0.0;
    for (int i = -(int)(4.0 / step); i <= (int)(4.0 / step); i++) {
        const double t = i * step, e = exp(-M_PI * sinh(t));
        const double part = 1.0 / (1.0 + e), rest = e / (1.0 + e); /* a and pi/2 - a, over pi/2 */
        const double weight = M_PI * cosh(t) * part * rest * 0.5 * M_PI;
        if (weight == 0.0 || part == 0.0)
            continue;
        const double tangent = part < 0.5 ? tan(0.5 * M_PI * part) / cosine
                                          : 1.0 / (tan(0.5 * M_PI * rest) * cosine);
        sum += weight * log_dispersion(albedo, atan(tangent), tangent);
    }
    return sum * step;
}

double neph_chandrasekhar_h(double albedo, double cosine)
{
    if (!(albedo >= 0.0 && albedo <= 1.0 && cosine >= 0.0 && cosine <= 1.0))
        return NAN;
    if (albedo == 0.0 || cosine == 0.0)
        return 1.0;
    double step = 0.25, before = double_exponential(albedo, cosine, step);
    for (int halving = 0; halving < 8; halving++) {
        step *= 0.5;
        const double now = double_exponential(albedo, cosine, step);
        if (fabs(now - before) < 1e-13)
            return exp(-now / M_PI);
        before = now;
    }
    return exp(-before / M_PI);
}

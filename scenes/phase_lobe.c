/* SPDX-License-Identifier: MIT */
#include "scenes/phase_lobe.h"

#include <math.h>
#include <stddef.h>

/* Henyey-Greenstein's: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)). */
static double henyey_greenstein_per_sr(double g, double c)
{
    /* 1 + g^2 - 2 g c without cancellation at the peak, for either sign of g. */
    const double base = g >= 0.0 ? (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c)
                                 : (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + c);
    return (1.0 - g) * (1.0 + g) / (4.0 * M_PI * base * sqrt(base));
}

/* The mean of 1 + alpha cos^2 over Henyey-Greenstein's. */
static double norm(struct neph_lobe lobe)
{
    return 1.0 + lobe.alpha * (1.0 + 2.0 * lobe.g * lobe.g) / 3.0;
}

double neph_lobe_per_sr(struct neph_lobe lobe, double cosine)
{
    const double c = fmin(1.0, fmax(-1.0, cosine));
    const double per_sr = henyey_greenstein_per_sr(lobe.g, c);
    return lobe.alpha == 0.0 ? per_sr : per_sr * (1.0 + lobe.alpha * c * c) / norm(lobe);
}

/* The light within versine v of straight ahead, for g >= 0.1: with t = sqrt(1 + g^2 - 2 g cos),
 * t0 = 1 - g and B = (1 + g^2) / 2g, the integral of (1 + alpha (B - t^2 / 2g)^2) / t^2 over t. */
static double peaked_part(struct neph_lobe lobe, double v)
{
    const double g = lobe.g, alpha = lobe.alpha;
    const double t0 = 1.0 - g, t = sqrt(t0 * t0 + 2.0 * g * v), b = (1.0 + g * g) / (2.0 * g);
    const double bracket = (1.0 + alpha * b * b) / (t * t0) - alpha * b / g +
                           alpha * (t * t + t * t0 + t0 * t0) / (12.0 * g * g);
    return (1.0 - g) * (1.0 + g) / norm(lobe) * v / (t + t0) * bracket;
}

/* The light within versine v for g < 0.1, where the formula above cancels: eight Gauss nodes, since
 * the nearest singularity is at cos = 5 or beyond. */
static double flat_part(struct neph_lobe lobe, double v)
{
    static const double nodes[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363};
    static const double weights[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    double sum = 0.0;
    for (size_t i = 0; i < sizeof(nodes) / sizeof(nodes[0]); i++)
        sum += weights[i] * (neph_lobe_per_sr(lobe, 1.0 - 0.5 * v * (1.0 - nodes[i])) +
                             neph_lobe_per_sr(lobe, 1.0 - 0.5 * v * (1.0 + nodes[i])));
    return M_PI * v * sum;
}

double neph_lobe_within(struct neph_lobe lobe, double v)
{
    if (lobe.g < 0.0)
        return 1.0 - neph_lobe_within((struct neph_lobe){-lobe.g, lobe.alpha}, 2.0 - v);
    return (lobe.g < 0.1 ? flat_part : peaked_part)(lobe, v);
}

double neph_lobe_mean_cosine(struct neph_lobe lobe)
{
    const double g = lobe.g;
    return lobe.alpha == 0.0 ? g : g * (1.0 + lobe.alpha * (3.0 + 2.0 * g * g) / 5.0) / norm(lobe);
}

/* Henyey-Greenstein's is g^l. cos^2 P_l is a sum of P_(l+2), P_l and P_(l-2), by the recurrence of
 * the Legendre polynomials applied twice. */
double neph_lobe_moment(struct neph_lobe lobe, int degree)
{
    const double l = degree, g = lobe.g;
    if (lobe.alpha == 0.0)
        return pow(g, l);
    const double above = (l + 1.0) * (l + 2.0) / ((2.0 * l + 1.0) * (2.0 * l + 3.0)),
                 below = l * (l - 1.0) / ((2.0 * l + 1.0) * (2.0 * l - 1.0)),
                 same = (l + 1.0) * (l + 1.0) / ((2.0 * l + 1.0) * (2.0 * l + 3.0)) +
                        l * l / ((2.0 * l + 1.0) * (2.0 * l - 1.0));
    const double lowest = degree >= 2 ? below * pow(g, l - 2.0) : 0.0;
    return (pow(g, l) + lobe.alpha * (above * pow(g, l + 2.0) + same * pow(g, l) + lowest)) /
           norm(lobe);
}

double neph_lobe_pair_per_sr(const struct neph_lobe_pair *pair, double cosine)
{
    return pair->first_share * neph_lobe_per_sr(pair->first, cosine) +
           (1.0 - pair->first_share) * neph_lobe_per_sr(pair->second, cosine);
}

double neph_lobe_pair_within(const struct neph_lobe_pair *pair, double v)
{
    return pair->first_share * neph_lobe_within(pair->first, v) +
           (1.0 - pair->first_share) * neph_lobe_within(pair->second, v);
}

double neph_lobe_pair_moment(const struct neph_lobe_pair *pair, int degree)
{
    return pair->first_share * neph_lobe_moment(pair->first, degree) +
           (1.0 - pair->first_share) * neph_lobe_moment(pair->second, degree);
}

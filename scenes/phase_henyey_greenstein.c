/* SPDX-License-Identifier: MIT
 *
 * L. G. Henyey, J. L. Greenstein, "Diffuse Radiation in the Galaxy", ApJ 93, 1941:
 * (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)), of mean cosine g.
 */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(double g, double cosine)
{
    const double c = fmin(1.0, fmax(-1.0, cosine));
    /* 1 + g^2 - 2 g c without cancellation at the peak, for either sign of g. */
    const double base = g >= 0.0 ? (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - c)
                                 : (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + c);
    return (1.0 - g) * (1.0 + g) / (4.0 * M_PI * base * sqrt(base));
}

/* The textbook form, 1 + g^2 - ((1 - g^2) / (1 - g + 2 g u))^2 over 2 g, cancels at both ends of g.
 * Its difference from 1, multiplied out, does not, and is valid at g = 0. */
static double versine(double g, double u)
{
    const double scale = (1.0 - g) / (1.0 - g + 2.0 * g * u);
    return 2.0 * scale * scale * (1.0 - u) * (1.0 + g * u);
}

static double mean_cosine(double g)
{
    return g;
}

static double moment(double g, int degree)
{
    return pow(g, degree);
}

const struct neph_phase_row neph_phase_henyey_greenstein = {
    .title = "Henyey-Greenstein",
    .has_asymmetry = true,
    .trial_count = 9,
    .trials = {0.0, 0.3, 0.85, 0.95, 0.99, 0.999, -0.3, -0.85, -0.999},
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

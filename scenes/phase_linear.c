/* SPDX-License-Identifier: MIT
 *
 * Scattering that is a little uneven, (1 + g cos) / (4 pi), of mean cosine g / 3: S. Chandrasekhar,
 * "Radiative Transfer", 1950, chapter 1.
 */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(double g, double cosine)
{
    return (1.0 + g * cosine) / (4.0 * M_PI);
}

/* The root of g v^2 / 4 - (1 + g) v / 2 + 1 - u = 0 in 0..2, without cancellation. */
static double versine(double g, double u)
{
    return 4.0 * (1.0 - u) / (1.0 + g + sqrt((1.0 - g) * (1.0 - g) + 4.0 * g * u));
}

static double mean_cosine(double g)
{
    return g / 3.0;
}

static double moment(double g, int degree)
{
    return degree == 1 ? g / 3.0 : 0.0;
}

const struct neph_phase_row neph_phase_linear = {
    .title = "linear",
    .has_asymmetry = true,
    .trial_count = 4,
    .trials = {0.0, 0.5, 0.999, -0.999},
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

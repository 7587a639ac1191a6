/* SPDX-License-Identifier: MIT
 *
 * Small particles: 3 / (16 pi) (1 + cos^2).
 */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(double g, double cosine)
{
    (void)g;
    return 3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine);
}

/* The cubic c^3 + 3 c = 8 u - 4 by its hyperbolic solution (J. R. Frisvad, JOSA A 28, 2011). */
static double versine(double g, double u)
{
    (void)g;
    return fmax(0.0, fmin(2.0, 1.0 - 2.0 * sinh(asinh(4.0 * u - 2.0) / 3.0)));
}

static double mean_cosine(double g)
{
    (void)g;
    return 0.0;
}

/* (3/4) (1 + c^2) = P_0 + P_2 / 2, where the coefficient of P_l is (2 l + 1) times its moment. */
static double moment(double g, int degree)
{
    (void)g;
    return degree == 2 ? 0.1 : 0.0;
}

const struct neph_phase_row neph_phase_rayleigh = {
    .title = "Rayleigh",
    .trial_count = 1,
    .trials = {0.0},
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

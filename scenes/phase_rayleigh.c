/* SPDX-License-Identifier: MIT
 *
 * Small particles: 3 / (16 pi) (1 + cos^2).
 */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(const struct neph_phase *phase, double cosine)
{
    (void)phase;
    return 3.0 / (16.0 * M_PI) * (1.0 + cosine * cosine);
}

/* The cubic c^3 + 3 c = 8 u - 4 by its hyperbolic solution (J. R. Frisvad, JOSA A 28, 2011). */
static double versine(const struct neph_phase *phase, double u)
{
    (void)phase;
    return fmax(0.0, fmin(2.0, 1.0 - 2.0 * sinh(asinh(4.0 * u - 2.0) / 3.0)));
}

static double mean_cosine(const struct neph_phase *phase)
{
    (void)phase;
    return 0.0;
}

/* (3/4) (1 + c^2) = P_0 + P_2 / 2, where the coefficient of P_l is (2 l + 1) times its moment. */
static double moment(const struct neph_phase *phase, int degree)
{
    (void)phase;
    return degree == 2 ? 0.1 : 0.0;
}

static const struct neph_phase trial = {.kind = NEPH_PHASE_RAYLEIGH};

const struct neph_phase_row neph_phase_rayleigh = {
    .title = "Rayleigh",
    .trial_count = 1,
    .trials = &trial,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

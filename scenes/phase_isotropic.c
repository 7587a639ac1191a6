/* SPDX-License-Identifier: MIT */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(const struct neph_phase *phase, double cosine)
{
    (void)phase, (void)cosine;
    return 1.0 / (4.0 * M_PI);
}

static double versine(const struct neph_phase *phase, double u)
{
    (void)phase;
    return 2.0 * (1.0 - u);
}

static double mean_cosine(const struct neph_phase *phase)
{
    (void)phase;
    return 0.0;
}

static double moment(const struct neph_phase *phase, int degree)
{
    (void)phase, (void)degree;
    return 0.0;
}

static const struct neph_phase trial = {.kind = NEPH_PHASE_ISOTROPIC};

const struct neph_phase_row neph_phase_isotropic = {
    .title = "isotropic",
    .trial_count = 1,
    .trials = &trial,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

/* SPDX-License-Identifier: MIT */
#include "scenes/phase.h"

#include <math.h>

static double per_sr(double g, double cosine)
{
    (void)g, (void)cosine;
    return 1.0 / (4.0 * M_PI);
}

static double versine(double g, double u)
{
    (void)g;
    return 2.0 * (1.0 - u);
}

static double mean_cosine(double g)
{
    (void)g;
    return 0.0;
}

static double moment(double g, int degree)
{
    (void)g, (void)degree;
    return 0.0;
}

const struct neph_phase_row neph_phase_isotropic = {
    .title = "isotropic",
    .trial_count = 1,
    .trials = {0.0},
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

/* SPDX-License-Identifier: MIT */
#include "renderer/octaves_fitted.h"

const struct neph_octaves_fit neph_octaves_fitted = {
#include "renderer/octaves_fitted.inc"
};

static double logistic(const double k[NEPH_OCTAVES_FEATURES], double g, double s)
{
    return 1.0 / (1.0 + exp(-(k[0] + k[1] * g + k[2] * g * g + k[3] * s + k[4] * g * s)));
}

struct neph_octaves neph_octaves_compute(const struct neph_octaves_fit *fit, double g,
                                         double albedo)
{
    const double seen_g = fmin(fmax(g, 0.0), NEPH_OCTAVES_FITTED_G_MAX);
    const double s = sqrt(1.0 - fmax(albedo, NEPH_OCTAVES_FITTED_ALBEDO_MIN));
    return (struct neph_octaves){.count = NEPH_OCTAVES_FITTED_COUNT,
                                 .contribution = albedo * logistic(fit->contribution, seen_g, s),
                                 .attenuation = logistic(fit->attenuation, seen_g, s),
                                 .eccentricity = logistic(fit->eccentricity, seen_g, s)};
}

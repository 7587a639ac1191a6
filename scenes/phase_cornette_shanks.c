/* SPDX-License-Identifier: MIT
 *
 * W. M. Cornette, J. G. Shanks, "Physically reasonable analytic expression for the
 * single-scattering phase function", Appl. Opt. 31, 1992: Henyey-Greenstein's times 1 + cos^2,
 * normalised; Rayleigh's at g = 0.
 */
#include "scenes/phase_inverse.h"
#include "scenes/phase_lobe.h"

#include <math.h>

static double per_sr(const struct neph_phase *phase, double cosine)
{
    return neph_lobe_per_sr((struct neph_lobe){phase->g, 1.0}, cosine);
}

static double within(const struct neph_phase *phase, double v)
{
    return neph_lobe_within((struct neph_lobe){phase->g, 1.0}, v);
}

static double versine(const struct neph_phase *phase, double u)
{
    struct neph_phase forward = *phase;
    forward.g = fabs(phase->g);
    return neph_phase_invert(&forward, within, u);
}

static double mean_cosine(const struct neph_phase *phase)
{
    return neph_lobe_mean_cosine((struct neph_lobe){phase->g, 1.0});
}

static double moment(const struct neph_phase *phase, int degree)
{
    return neph_lobe_moment((struct neph_lobe){phase->g, 1.0}, degree);
}

static const struct neph_phase trials[] = {{.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.0},
                                           {.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.05},
                                           {.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.3},
                                           {.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.85},
                                           {.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = 0.99},
                                           {.kind = NEPH_PHASE_CORNETTE_SHANKS, .g = -0.6}};

const struct neph_phase_row neph_phase_cornette_shanks = {
    .title = "Cornette-Shanks",
    .parameters = NEPH_PHASE_PARAMETER_G,
    .trial_count = sizeof(trials) / sizeof(trials[0]),
    .trials = trials,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

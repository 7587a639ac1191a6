/* SPDX-License-Identifier: MIT
 *
 * B. T. Draine, "Scattering by Interstellar Dust Grains. I. Optical and Ultraviolet", ApJ 598,
 * 2003: Henyey-Greenstein's times 1 + alpha cos^2, normalised.
 */
#include "scenes/phase_inverse.h"
#include "scenes/phase_lobe.h"

#include <math.h>

static double per_sr(const struct neph_phase *phase, double cosine)
{
    return neph_lobe_per_sr((struct neph_lobe){phase->g, phase->draine_alpha}, cosine);
}

static double within(const struct neph_phase *phase, double v)
{
    return neph_lobe_within((struct neph_lobe){phase->g, phase->draine_alpha}, v);
}

static double versine(const struct neph_phase *phase, double u)
{
    struct neph_phase forward = *phase;
    forward.g = fabs(phase->g);
    return neph_phase_invert(&forward, within, u);
}

static double mean_cosine(const struct neph_phase *phase)
{
    return neph_lobe_mean_cosine((struct neph_lobe){phase->g, phase->draine_alpha});
}

static double moment(const struct neph_phase *phase, int degree)
{
    return neph_lobe_moment((struct neph_lobe){phase->g, phase->draine_alpha}, degree);
}

static const struct neph_phase trials[] = {
    {.kind = NEPH_PHASE_DRAINE, .g = 0.0, .draine_alpha = 1.0},
    {.kind = NEPH_PHASE_DRAINE, .g = 0.09, .draine_alpha = 5.0},
    {.kind = NEPH_PHASE_DRAINE, .g = 0.5, .draine_alpha = 20.0},
    {.kind = NEPH_PHASE_DRAINE, .g = 0.9, .draine_alpha = 250.0},
    {.kind = NEPH_PHASE_DRAINE, .g = 0.99, .draine_alpha = 0.5},
    {.kind = NEPH_PHASE_DRAINE, .g = -0.6, .draine_alpha = 2.0}};

const struct neph_phase_row neph_phase_draine = {
    .title = "Draine",
    .parameters = NEPH_PHASE_PARAMETER_G | NEPH_PHASE_PARAMETER_ALPHA,
    .trial_count = sizeof(trials) / sizeof(trials[0]),
    .trials = trials,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

/* SPDX-License-Identifier: MIT
 *
 * L. G. Henyey, J. L. Greenstein, "Diffuse Radiation in the Galaxy", ApJ 93, 1941:
 * (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)), of mean cosine g.
 */
#include "scenes/phase.h"
#include "scenes/phase_lobe.h"

#include <math.h>

static double per_sr(const struct neph_phase *phase, double cosine)
{
    return neph_lobe_per_sr((struct neph_lobe){phase->g, 0.0}, cosine);
}

/* The textbook form, 1 + g^2 - ((1 - g^2) / (1 - g + 2 g u))^2 over 2 g, cancels at both ends of g.
 * Its difference from 1, multiplied out, does not, and is valid at g = 0. */
static double versine(const struct neph_phase *phase, double u)
{
    const double g = fabs(phase->g);
    const double scale = (1.0 - g) / (1.0 - g + 2.0 * g * u);
    return 2.0 * scale * scale * (1.0 - u) * (1.0 + g * u);
}

static double mean_cosine(const struct neph_phase *phase)
{
    return phase->g;
}

static double moment(const struct neph_phase *phase, int degree)
{
    return neph_lobe_moment((struct neph_lobe){phase->g, 0.0}, degree);
}

#define TRIAL(asymmetry)                                                                           \
    {                                                                                              \
        .kind = NEPH_PHASE_HENYEY_GREENSTEIN, .g = (asymmetry)                                     \
    }
static const struct neph_phase trials[] = {TRIAL(0.0),  TRIAL(0.3),   TRIAL(0.85),
                                           TRIAL(0.95), TRIAL(0.99),  TRIAL(0.999),
                                           TRIAL(-0.3), TRIAL(-0.85), TRIAL(-0.999)};

const struct neph_phase_row neph_phase_henyey_greenstein = {
    .title = "Henyey-Greenstein",
    .parameters = NEPH_PHASE_PARAMETER_G,
    .trial_count = sizeof(trials) / sizeof(trials[0]),
    .trials = trials,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

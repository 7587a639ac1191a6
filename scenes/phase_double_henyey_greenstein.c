/* SPDX-License-Identifier: MIT
 *
 * Two lobes of Henyey-Greenstein, the usual sum of a forward and a backward one; the first one's
 * asymmetry is not negative.
 */
#include "scenes/phase_inverse.h"
#include "scenes/phase_lobe.h"

static struct neph_lobe_pair pair_from(const struct neph_phase *phase)
{
    return (struct neph_lobe_pair){{phase->g, 0.0}, {phase->second_g, 0.0}, phase->first_share};
}

static double per_sr(const struct neph_phase *phase, double cosine)
{
    const struct neph_lobe_pair pair = pair_from(phase);
    return neph_lobe_pair_per_sr(&pair, cosine);
}

static double within(const struct neph_phase *phase, double v)
{
    const struct neph_lobe_pair pair = pair_from(phase);
    return neph_lobe_pair_within(&pair, v);
}

static double versine(const struct neph_phase *phase, double u)
{
    return neph_phase_invert(phase, within, u);
}

static double moment(const struct neph_phase *phase, int degree)
{
    const struct neph_lobe_pair pair = pair_from(phase);
    return neph_lobe_pair_moment(&pair, degree);
}

static double mean_cosine(const struct neph_phase *phase)
{
    return moment(phase, 1);
}

static const struct neph_phase trials[] = {
    {.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, .g = 0.85, .second_g = -0.3, .first_share = 0.9},
    {.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, .g = 0.99, .second_g = 0.5, .first_share = 0.5},
    {.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, .g = 0.3, .second_g = -0.3, .first_share = 1.0},
    {.kind = NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, .g = 0.8, .second_g = -0.5, .first_share = 0.0}};

const struct neph_phase_row neph_phase_double_henyey_greenstein = {
    .title = "double Henyey-Greenstein",
    .parameters = NEPH_PHASE_PARAMETER_G | NEPH_PHASE_PARAMETER_LOBES,
    .trial_count = sizeof(trials) / sizeof(trials[0]),
    .trials = trials,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

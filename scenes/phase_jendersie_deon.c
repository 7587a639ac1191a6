/* SPDX-License-Identifier: MIT
 *
 * J. Jendersie, E. d'Eon, "An Approximate Mie Scattering Function for Fog and Cloud Rendering",
 * SIGGRAPH 2023 Talks, equations 4 to 7: a lobe of Henyey-Greenstein's and one of Draine's, fitted
 * to water droplets of a diameter of 5 to 50 um.
 */
#include "scenes/phase_inverse.h"
#include "scenes/phase_lobe.h"

#include <math.h>

static struct neph_lobe_pair pair_from(const struct neph_phase *phase)
{
    const double d = phase->droplet_diameter_um;
    const double in_draine = exp(-0.599085 / (d - 0.641583) - 0.665888);
    return (struct neph_lobe_pair){
        .first = {exp(-0.0990567 / (d - 1.67154)), 0.0},
        .second = {exp(-2.20679 / (d + 3.91029) - 0.428934),
                   exp(3.62489 - 8.29288 / (d + 5.52825))},
        .first_share = 1.0 - in_draine,
    };
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
    {.kind = NEPH_PHASE_JENDERSIE_DEON, .droplet_diameter_um = 5.0},
    {.kind = NEPH_PHASE_JENDERSIE_DEON, .droplet_diameter_um = 20.0},
    {.kind = NEPH_PHASE_JENDERSIE_DEON, .droplet_diameter_um = 50.0}};

const struct neph_phase_row neph_phase_jendersie_deon = {
    .title = "Jendersie-d'Eon",
    .parameters = NEPH_PHASE_PARAMETER_DIAMETER,
    .trial_count = sizeof(trials) / sizeof(trials[0]),
    .trials = trials,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

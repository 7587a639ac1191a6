/* SPDX-License-Identifier: MIT
 *
 * Type 3 of POV-Ray's `scattering`: 1 + 50 ((1 + cos) / 2)^32, normalised.
 */
#include "scenes/phase_inverse.h"
#include "scenes/phase_povray.h"

static const struct neph_haze haze = {50.0, 32};

static double per_sr(const struct neph_phase *phase, double cosine)
{
    (void)phase;
    return neph_haze_per_sr(haze, cosine);
}

static double within(const struct neph_phase *phase, double v)
{
    (void)phase;
    return neph_haze_within(haze, v);
}

static double versine(const struct neph_phase *phase, double u)
{
    return neph_phase_invert(phase, within, u);
}

static double moment(const struct neph_phase *phase, int degree)
{
    (void)phase;
    return neph_haze_moment(haze, degree);
}

static double mean_cosine(const struct neph_phase *phase)
{
    return moment(phase, 1);
}

static const struct neph_phase trial = {.kind = NEPH_PHASE_POVRAY_MIE_MURKY};

const struct neph_phase_row neph_phase_povray_mie_murky = {
    .title = "POV-Ray's murky Mie",
    .trial_count = 1,
    .trials = &trial,
    .per_sr = per_sr,
    .versine = versine,
    .mean_cosine = mean_cosine,
    .moment = moment,
};

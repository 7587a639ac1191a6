/* SPDX-License-Identifier: MIT */
#include "scenes/phase_colour.h"

#include "scenes/phase_table.h"

bool neph_phase_is_coloured(const struct neph_phase *phase)
{
    return phase->table && phase->table->channels[0];
}

struct neph_phase neph_phase_channel(const struct neph_phase *phase, int channel)
{
    struct neph_phase own = *phase;
    if (neph_phase_is_coloured(phase))
        own.table = phase->table->channels[channel];
    return own;
}

struct neph_rgb neph_phase_rgb_per_sr(const struct neph_phase *phase, double cosine)
{
    if (!neph_phase_is_coloured(phase)) {
        const double per_sr = neph_phase_per_sr(phase, cosine);
        return (struct neph_rgb){per_sr, per_sr, per_sr};
    }
    double of_channels[3];
    for (int j = 0; j < 3; j++) {
        const struct neph_phase own = neph_phase_channel(phase, j);
        of_channels[j] = neph_phase_per_sr(&own, cosine);
    }
    return (struct neph_rgb){of_channels[0], of_channels[1], of_channels[2]};
}

/* SPDX-License-Identifier: MIT */
#include "scenes/phase_same.h"

#include "scenes/phase_table.h"

bool neph_phase_is_same(const struct neph_phase *a, const struct neph_phase *b)
{
    return a->kind == b->kind && a->g == b->g && a->second_g == b->second_g &&
           a->first_share == b->first_share && a->draine_alpha == b->draine_alpha &&
           a->droplet_diameter_um == b->droplet_diameter_um &&
           neph_phase_table_is_same(a->table, b->table);
}

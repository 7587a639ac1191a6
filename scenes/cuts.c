/* SPDX-License-Identifier: MIT */
#include "scenes/cuts.h"

#include "scenes/bounds.h"

void neph_cuts_add(struct neph_cuts *cuts, double t_m)
{
    if (t_m > cuts->t0_m && t_m < cuts->t1_m && cuts->count < NEPH_CUTS_MAX - 2)
        cuts->at_m[cuts->count++] = t_m;
}

bool neph_cuts_clip(const struct neph_cuts *cuts, const struct neph_bounds *bounds, double *t0_m,
                    double *t1_m)
{
    *t0_m = cuts->t0_m;
    *t1_m = cuts->t1_m;
    return neph_bounds_clip(bounds, cuts->origin_m, cuts->direction, t0_m, t1_m);
}

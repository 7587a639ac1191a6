/* SPDX-License-Identifier: MIT */
#include "renderer/media/kind.h"

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

static const struct neph_gpu_kind *const kinds[NEPH_MEDIUM_KIND_COUNT] = {
    [NEPH_MEDIUM_HOMOGENEOUS] = &neph_gpu_homogeneous,
    [NEPH_MEDIUM_HEIGHT_FOG] = &neph_gpu_height_fog,
    [NEPH_MEDIUM_GAUSSIAN] = &neph_gpu_gaussian,
    [NEPH_MEDIUM_SHELL] = &neph_gpu_shell,
    [NEPH_MEDIUM_GRID] = &neph_gpu_grid,
    [NEPH_MEDIUM_HORIZON] = &neph_gpu_horizon,
    [NEPH_MEDIUM_PLUME] = &neph_gpu_plume,
    [NEPH_MEDIUM_TENT] = &neph_gpu_tent,
};

const struct neph_gpu_kind *neph_gpu_get_kind(const struct neph_medium *medium)
{
    return kinds[medium->kind];
}

double neph_gpu_largest_per_m(const struct neph_medium *medium)
{
    const struct neph_gpu_kind *kind = neph_gpu_get_kind(medium);
    return kind->largest_per_m ? kind->largest_per_m(medium) : medium->extinction_per_m;
}

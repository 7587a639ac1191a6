/* SPDX-License-Identifier: MIT */
#include "harness/sweep/results.h"

#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SWEEP_NUMBERS == 5, "a new kind");

const struct neph_sweep_number_text neph_sweep_number_texts[NEPH_SWEEP_NUMBERS] = {
    [NEPH_SWEEP_ERROR] = {"error", "relative RMSE of radiance against the truth", "rel_rmse"},
    [NEPH_SWEEP_SHORTCUT] = {"shortcut", "relative RMSE of radiance against its own model",
                             "rel_rmse"},
    [NEPH_SWEEP_FLICKER] = {"flicker", "flicker seen, contrast over threshold", "seen_contrast"},
    [NEPH_SWEEP_FOUR] = {"four", "four-frame flicker, 95th percentile, of white", "a4_p95"},
    [NEPH_SWEEP_HALF_LIFE] = {"half_life", "half-life after a step of the sun [frames]",
                              "half_life_p50"},
};

void neph_sweep_finish(struct neph_sweep *sweep)
{
    for (int i = 0; i < sweep->point_count; i++)
        free(sweep->points[i].settings);
    free(sweep->points);
    free(sweep->infos);
    for (int i = 0; i <= NEPH_SCATTERING_MULTIPLE; i++)
        neph_scene_destroy(sweep->rescattered[i]);
    neph_scene_destroy(sweep->scene);
    *sweep = (struct neph_sweep){.plan = NULL};
}

/* SPDX-License-Identifier: MIT
 *
 * Configurations of `neph pick` by engine and by name: `-e march`, `--only ours,octaves`.
 */
#ifndef NEPH_HARNESS_SWEEP_LADDER_FILTER_H
#define NEPH_HARNESS_SWEEP_LADDER_FILTER_H

#include "harness/sweep/ladder.h"

/* All zero: every configuration. Names are borrowed. */
struct neph_ladder_filter {
    const char *const *engines; /* "march" stands for march_octaves and the other march_X, too */
    int engine_count;
    const char *const *only; /* a preset, a light, or a whole name: "ours", "octaves" or
                                "ours, octaves" */
    int only_count;
};

bool neph_ladder_wants_engine(const struct neph_ladder_filter *filter, const char *engine);

/* Remove the series of a plan that the filter does not name. */
void neph_ladder_filter(const struct neph_ladder_filter *filter, struct neph_sweep_plan *plan);

/* NEPH_ERR_USAGE: a name of the filter stands for no series of the scene's plans, or all names
 * together leave no series; the names that there are follow. */
enum neph_status neph_ladder_filter_check(const struct neph_ladder_filter *filter,
                                          const struct neph_scene *scene, struct neph_diag *diag);

#endif

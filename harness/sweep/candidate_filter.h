/* SPDX-License-Identifier: MIT
 *
 * Filter of the candidates of `neph pick` by engine and name: `-e march`, `--only ours,octaves`.
 */
#ifndef NEPH_HARNESS_SWEEP_CANDIDATE_FILTER_H
#define NEPH_HARNESS_SWEEP_CANDIDATE_FILTER_H

#include "harness/sweep/candidates.h"

/* All zero: every candidate. Names are borrowed. */
struct neph_candidate_filter {
    const char *const *engines; /* "march" includes march_octaves and all other march_X */
    int engine_count;
    const char *const *only; /* a preset, a lighting model, or a whole name: "ours", "octaves" or
                                "ours, octaves" */
    int only_count;
};

/* Whether the filter includes an engine. */
bool neph_candidate_filter_has_engine(const struct neph_candidate_filter *filter,
                                      const char *engine);

/* Removes the series of a plan that do not match. */
void neph_candidate_filter(const struct neph_candidate_filter *filter,
                           struct neph_sweep_plan *plan);

/* NEPH_ERR_USAGE: a name matches no series of the scene's plans, or no series matches all; the hint
 * lists the existing names. */
enum neph_status neph_candidate_filter_check(const struct neph_candidate_filter *filter,
                                             const struct neph_scene *scene,
                                             struct neph_diag *diag);

#endif

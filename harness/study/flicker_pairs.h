/* SPDX-License-Identifier: MIT
 *
 * What two presets of a study differ by. The scene is the unit of replication: seeds of a scene
 * share its geometry and are averaged first, in decades, as are differences.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_PAIRS_H
#define NEPH_HARNESS_STUDY_FLICKER_PAIRS_H

#include "harness/study/flicker_study.h"

/* first over second, in decades: below 0 the first is better. In a scene where a bound stands for
 * the number of one, what lies below it is alike: the bound is the floor of both. */
struct neph_study_pair {
    int scene_count; /* in which both have a number that counts */
    double mean;     /* NaN without a scene */
    bool has_interval;
    double low, high; /* 95 %, Student's t over scenes (metrics/series.h); from two scenes on */
    int better, worse, alike; /* scenes in which the first is; below the floor all are alike */
    double p_sign;            /* two-sided, exact sign test on these */
};

/* What they differ by in one scene; NaN when one of them has no number that counts there. */
double neph_study_difference(const struct neph_flicker_study *study, int metric, int display,
                             int first, int second, int scene);

/* log10 of a cost of a preset in a scene, mean over seeds; NaN where a seed has none. The offset
 * `cost` is in struct neph_study_cost. */
double neph_study_cost_decades(const struct neph_flicker_study *study, size_t cost, int scene,
                               int preset);

/* Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_pair(const struct neph_flicker_study *study, int metric, int display,
                                 int first, int second, struct neph_study_pair *pair,
                                 struct neph_diag *diag);

/* 1: the interval lies above 0, the first is worse; -1: better; 0: neither is certain. */
int neph_study_pair_verdict(const struct neph_study_pair *pair);

/* A preset's metric over the scenes in which all presets have one. */
struct neph_study_level {
    int scene_count;
    double mean; /* of log10; NaN without a scene */
    bool has_interval;
    double low, high; /* 95 %, of what the preset differs from the mean of all presets in the same
                         scene (D. Cousineau 2005): how bright or thin a scene is widens it not */
};

/* `levels` has room for all presets. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_levels(const struct neph_flicker_study *study, int metric, int display,
                                   struct neph_study_level *levels, struct neph_diag *diag);

/* Presets from the best to the worst by the headline at a display; those without a level last.
 * `order` has room for all. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_ranking(const struct neph_flicker_study *study, int display, int *order,
                                    struct neph_diag *diag);

#endif

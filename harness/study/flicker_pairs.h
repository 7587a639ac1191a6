/* SPDX-License-Identifier: MIT
 *
 * Differences between two presets of a flicker study. The scenes are the sample: seeds of a scene
 * share its geometry and are averaged first, in decades like the differences.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_PAIRS_H
#define NEPH_HARNESS_STUDY_FLICKER_PAIRS_H

#include "harness/study/flicker_study.h"

/* The first preset relative to the second, in decades; negative: the first is better. In a scene
 * where an upper bound replaces the value of one preset, the bound is the least value of both, so
 * smaller values count as equal. */
struct neph_study_pair {
    int scene_count; /* scenes in which both presets have a value that counts */
    double mean;     /* NaN without a scene */
    bool has_interval;
    double low, high; /* 95 %, Student's t over scenes (metrics/series.h); from two scenes on */
    int better, worse, alike; /* scenes by sign of the difference; values below the least one are
                                 equal */
    double p_sign;            /* two-sided exact sign test on these counts */
};

/* The difference in one scene; NaN when one preset has no value that counts. */
double neph_study_difference(const struct neph_flicker_study *study, int metric, int display,
                             int first, int second, int scene);

/* log10 of a cost of a preset in a scene, mean over seeds; NaN when a seed has none. `cost` is an
 * offset in struct neph_study_cost. */
double neph_study_cost_decades(const struct neph_flicker_study *study, size_t cost, int scene,
                               int preset);

/* Compares two presets over all scenes. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_pair(const struct neph_flicker_study *study, int metric, int display,
                                 int first, int second, struct neph_study_pair *pair,
                                 struct neph_diag *diag);

/* A preset relative to its floor in a scene. */
struct neph_study_scene_gap {
    double preset, floor; /* decades, means over seeds; NaN unless the preset and both candidates of
                             the floor have a value that counts */
    int lower;            /* the configuration with the lower value, which is the floor; -1: none */
};
struct neph_study_scene_gap neph_study_scene_gap(const struct neph_flicker_study *study, int metric,
                                                 int display, int preset, int scene);

/* A preset relative to its floors, scene by scene. */
struct neph_study_gap {
    struct neph_study_pair pair; /* over the scenes with a gap */
    double preset, floor;        /* decades, means over the same scenes; NaN without a scene */
};

/* Compares a preset with its floor over all scenes; a study without floors has no gap in any scene.
 * Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_gap(const struct neph_flicker_study *study, int metric, int display,
                                int preset, struct neph_study_gap *gap, struct neph_diag *diag);

/* 1: the interval lies above 0, the first preset is worse; -1: it is better; 0: undecided. */
int neph_study_pair_verdict(const struct neph_study_pair *pair);

/* Mean of a preset's metric over the scenes in which all presets have a value. */
struct neph_study_level {
    int scene_count;
    double mean; /* of log10; NaN without a scene */
    bool has_interval;
    double low, high; /* 95 %, of the preset's difference from the mean of all presets in the same
                         scene (D. Cousineau 2005), so differences between scenes do not widen it */
};

/* Computes the levels of all presets. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_levels(const struct neph_flicker_study *study, int metric, int display,
                                   struct neph_study_level *levels, struct neph_diag *diag);

/* Computes the levels of the floors of all presets, in the same scenes. */
enum neph_status neph_study_floor_levels(const struct neph_flicker_study *study, int metric,
                                         int display, struct neph_study_level *levels,
                                         struct neph_diag *diag);

/* Writes the indices of all presets to `order`, best first by the headline metric for a display;
 * presets without a level come last. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_study_ranking(const struct neph_flicker_study *study, int display, int *order,
                                    struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Chooses one preset out of several by their results over many scenes: the presets on the Pareto
 * front of all measures, then those within a budget, then the one with the smallest value of one
 * measure. The results come from a flicker study; the choice should be judged on other scenes.
 */
#ifndef NEPH_HARNESS_SWEEP_CHOICE_H
#define NEPH_HARNESS_SWEEP_CHOICE_H

#include "harness/json.h"
#include "harness/study/flicker_pairs.h"

/* Measures of a preset. Smaller is better for all of them. */
enum neph_choice_number {
    NEPH_CHOICE_FLICKER,   /* visible flicker, over the whole frame */
    NEPH_CHOICE_HALF_LIFE, /* after a step of the sun */
    NEPH_CHOICE_LAG,       /* behind a sun that swings in 64 frames */
    NEPH_CHOICE_ERROR,     /* shortcut error: against the marcher with the same steps and lighting
                              */
    NEPH_CHOICE_WORK,      /* density evaluations, counted */
    NEPH_CHOICE_TIME,      /* device time; part of the front only when requested */
    NEPH_CHOICE_NUMBERS,
};

struct neph_choice_measure {
    const char *name;  /* in options and JSON: "half-life" */
    const char *title; /* with unit */
    enum neph_study_capture_id take;
    const char *metric, *mask; /* of neph_study_metrics; NULL: the measure is a cost */
    size_t cost;               /* offset in struct neph_study_cost */
};
extern const struct neph_choice_measure neph_choice_measures[NEPH_CHOICE_NUMBERS];

/* Index of a measure by name; -1: none. */
int neph_choice_find(const char *name);

/* Levels within 1 % count as equal for the choice. */
#define NEPH_CHOICE_ALIKE 1.01

struct neph_choice_candidate {
    double levels[NEPH_CHOICE_NUMBERS]; /* geometric means over the scenes in which all candidates
                                           have a value; NaN: none */
    double floors[NEPH_CHOICE_NUMBERS]; /* likewise of its floor; NaN: none, as for costs */
    bool on_front;                      /* of all measures that every candidate has; time only when
                                           requested */
    bool is_within;                     /* within the budget */
    int beaten_by;                      /* a candidate that is at least as good in all measures; -1:
                                           none */
};

struct neph_choice {
    double budget[NEPH_CHOICE_NUMBERS]; /* largest allowed level; NaN: no limit */
    enum neph_choice_number least;      /* the measure that the choice minimises */
    int scene_counts[NEPH_CHOICE_NUMBERS];
    int candidate_count;
    struct neph_choice_candidate candidates[NEPH_STUDY_PRESETS_MAX];
    int chosen;  /* -1: no candidate is within the budget */
    int nearest; /* nearest to the budget, or the chosen one */
};

/* Computes the levels from a finished study, then judges. `budget` and `least` are set by the
 * caller. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_choice_make(const struct neph_flicker_study *study,
                                  struct neph_choice *choice, struct neph_diag *diag);

/* Computes front, budget and choice from the levels. Among candidates whose level of `least` is
 * equal, the one with the smallest product of all levels is chosen. */
void neph_choice_judge(struct neph_choice *choice);

/* Prints the candidates, the choice, and its differences from every other candidate with intervals
 * over scenes. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_choice_print(const struct neph_choice *choice,
                                   const struct neph_flicker_study *study, FILE *out,
                                   struct neph_diag *diag);

/* The choice as a configuration (harness/run/configuration.h), with all candidates and their levels
 * in "candidates"; for json_decref(). */
json_t *neph_choice_json(const struct neph_choice *choice, const struct neph_flicker_study *study);

#endif

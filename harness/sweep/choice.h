/* SPDX-License-Identifier: MIT
 *
 * A preset out of several, by what they do over many scenes: which of them nothing else beats in
 * every number at once, and which of these is within a budget at the least of one of them. Built
 * on a flicker study; what is said of the choice afterwards is said of other scenes.
 */
#ifndef NEPH_HARNESS_SWEEP_CHOICE_H
#define NEPH_HARNESS_SWEEP_CHOICE_H

#include "harness/json.h"
#include "harness/study/flicker_pairs.h"

/* What is weighed. Of all less is better. */
enum neph_choice_number {
    NEPH_CHOICE_FLICKER,   /* seen, over the whole picture */
    NEPH_CHOICE_HALF_LIFE, /* after a step of the sun */
    NEPH_CHOICE_LAG,       /* behind a sun that swings in 64 frames */
    NEPH_CHOICE_ERROR,     /* of the shortcut: against the march of its own steps and light */
    NEPH_CHOICE_WORK,      /* density evaluations, counted */
    NEPH_CHOICE_TIME,      /* of the device; no part of the front unless it is asked for */
    NEPH_CHOICE_NUMBERS,
};

struct neph_choice_measure {
    const char *name;  /* of options and JSON: "half-life" */
    const char *title; /* with the unit */
    enum neph_study_take_id take;
    const char *metric, *mask; /* of neph_study_metrics; NULL: a cost */
    size_t cost;               /* offset in struct neph_study_cost */
};
extern const struct neph_choice_measure neph_choice_measures[NEPH_CHOICE_NUMBERS];

/* -1: there is no number of that name. */
int neph_choice_find(const char *name);

/* Levels that differ by less are alike where they decide between equals: 1 %. */
#define NEPH_CHOICE_ALIKE 1.01

struct neph_choice_candidate {
    double levels[NEPH_CHOICE_NUMBERS]; /* geometric means over the scenes in which all candidates
                                           have the number; NaN: there is none */
    bool on_front;                      /* of all numbers that every candidate has, but time */
    bool is_within;                     /* the budget */
    int beaten_by;                      /* one that is at least as good in all; -1: none */
};

struct neph_choice {
    double budget[NEPH_CHOICE_NUMBERS]; /* the most a level may be; NaN: any */
    enum neph_choice_number least;      /* of which the choice has the least */
    int scene_counts[NEPH_CHOICE_NUMBERS];
    int candidate_count;
    struct neph_choice_candidate candidates[NEPH_STUDY_PRESETS_MAX];
    int chosen;  /* -1: none is within the budget */
    int nearest; /* to the budget, where none is within it; else the chosen one */
};

/* Fill levels from a study that has run, then judge. `budget` and `least` are set. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_choice_make(const struct neph_flicker_study *study,
                                  struct neph_choice *choice, struct neph_diag *diag);

/* Front, budget and choice from the levels. Among candidates alike in `least` that one is chosen
 * which has the least product of the other numbers. */
void neph_choice_judge(struct neph_choice *choice);

/* A table of the candidates, the choice, and what it is better and worse in than each other with
 * intervals over scenes. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_choice_print(const struct neph_choice *choice,
                                   const struct neph_flicker_study *study, FILE *out,
                                   struct neph_diag *diag);

/* The choice as a configuration (harness/run/configuration.h), with "candidates" and all their
 * numbers beside it; for the caller to json_decref. */
json_t *neph_choice_json(const struct neph_choice *choice, const struct neph_flicker_study *study);

#endif

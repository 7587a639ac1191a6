/* SPDX-License-Identifier: MIT
 *
 * An ablation: what each part of the real-time renderer does to error, flicker, lag and cost. It is
 * a flicker study (flicker_study.h) of a preset, the preset without each part, the plain pipeline
 * that has none of them, and that pipeline with each part alone.
 */
#ifndef NEPH_HARNESS_STUDY_ABLATION_H
#define NEPH_HARNESS_STUDY_ABLATION_H

#include "harness/study/ablation_parts.h"
#include "harness/study/flicker_study.h"

#include <stdio.h>

/* What is looked at. Of all less is better. */
struct neph_ablation_measure {
    const char *name;          /* of JSON, CSV and sentences */
    const char *column;        /* of narrow tables */
    const char *title;         /* of others, and of charts */
    const char *metric, *mask; /* of neph_study_metrics; NULL: it is a cost */
    size_t cost;               /* offset of the cost in struct neph_study_cost */
    bool is_time;              /* of a clock: shown, and decides nothing */
};
enum { NEPH_ABLATION_MEASURES_MAX = 8 };

/* Ends with a NULL name. */
extern const struct neph_ablation_measure neph_ablation_measures[];
int neph_ablation_measure_count(void);

/* Where a part is switched. */
enum neph_ablation_place {
    NEPH_ABLATION_IN_PRESET, /* the preset against the preset without it */
    NEPH_ABLATION_ALONE,     /* the plain pipeline with it (and with what it needs) against that
                                without it */
    NEPH_ABLATION_PLACES,
};

/* What is said of a change. "Nothing" is a change of less than 5 % either way: a choice, what would
 * hardly be a reason to keep a part. */
enum neph_ablation_verdict {
    NEPH_ABLATION_NO_NUMBER,
    NEPH_ABLATION_SAME,    /* in no scene any change */
    NEPH_ABLATION_NOTHING, /* the interval lies within 5 % */
    NEPH_ABLATION_BUYS,    /* less of what is measured; p below 0.05 after S. Holm over all */
    NEPH_ABLATION_MAY_BUY, /* its own interval says so, that of the family does not */
    NEPH_ABLATION_COSTS,   /* more */
    NEPH_ABLATION_MAY_COST,
    NEPH_ABLATION_UNDECIDED, /* too few scenes, or they disagree */
    NEPH_ABLATION_VERDICTS,
};
extern const char *const neph_ablation_verdict_words[NEPH_ABLATION_VERDICTS];

/* log10(1.05) */
#define NEPH_ABLATION_NOTHING_DECADES 0.0211892990699381

/* With the part over without it, in decades: below 0 it buys. Seeds of a scene are averaged, scenes
 * are what is counted. */
struct neph_ablation_effect {
    const double *scenes; /* of each scene of the study; NaN: none; of the ablation's arena */
    int scene_count;      /* that have a number */
    double mean;          /* NaN: none has */
    bool has_interval;
    double low, high; /* 95 %, Student's t over scenes */
    double p, p_holm; /* two-sided; 1 where nothing is judged */
    int better, worse, alike;
    int best_scene, worst_scene; /* of the largest change down and up; -1: in none */
    enum neph_ablation_verdict verdict;
};

/* A part in a place; or all of them at once, the preset against the plain pipeline. */
struct neph_ablation_comparison {
    int part; /* -1: all */
    enum neph_ablation_place place;
    int with, without; /* configurations, presets of the study */
    struct neph_ablation_effect effects[NEPH_ABLATION_MEASURES_MAX];
};

struct neph_ablation {
    const char *preset;                          /* borrowed */
    struct neph_arena arena;                     /* has all texts and differences */
    neph_ablation_set parts;                     /* that the preset has */
    neph_ablation_set asked;                     /* of these, those that are looked at */
    const char *values[NEPH_ABLATION_PARTS_MAX]; /* neph_ablation_part_values() */
    const char *words[NEPH_STUDY_PRESETS_MAX];   /* of each configuration */
    const char *labels[NEPH_STUDY_PRESETS_MAX];  /* what progress calls it */
    neph_ablation_set without[NEPH_STUDY_PRESETS_MAX];
    int configuration_count;
    struct neph_ablation_comparison comparisons[2 * NEPH_ABLATION_PARTS_MAX + 1];
    int comparison_count;
    struct neph_flicker_study study; /* of the configurations, once it has run */
    int judged_count;                /* numbers that Holm's family has */
};

/* Which configurations an ablation has. `only`: names of parts, or none for all that the preset
 * has. Start from {0}; for _finish in any case. NEPH_ERR_USAGE: there is no such part or preset, or
 * the preset does not have the part. */
enum neph_status neph_ablation_plan(const char *preset, const char *const *only, int only_count,
                                    struct neph_ablation *ablation, struct neph_diag *diag);

/* Fill all effects from the numbers of the study. NEPH_ERR_UNSUPPORTED: none of its scenes could be
 * rendered; NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_judge(struct neph_ablation *ablation, struct neph_diag *diag);

void neph_ablation_finish(struct neph_ablation *ablation);

/* The comparison of a part in a place; NULL: there is none. -1: of all at once. */
const struct neph_ablation_comparison *neph_ablation_find(const struct neph_ablation *ablation,
                                                          int part, enum neph_ablation_place place);

/* What follows for the preset from what a part does in it. */
enum neph_ablation_advice {
    NEPH_ABLATION_KEEP,      /* it buys something */
    NEPH_ABLATION_PERHAPS,   /* it may buy something */
    NEPH_ABLATION_UNTOLD,    /* what it buys cannot be told from nothing, in one measure at least */
    NEPH_ABLATION_LEAVE_OUT, /* it buys nothing, and costs or may cost something */
    NEPH_ABLATION_LITTLE,    /* it changes nothing by 5 % */
    NEPH_ABLATION_IDLE,      /* it changes no number in any scene */
    NEPH_ABLATION_UNMEASURED, /* no scene has a number */
    NEPH_ABLATION_ADVICES,
};
extern const char *const neph_ablation_advice_words[NEPH_ABLATION_ADVICES];
enum neph_ablation_advice neph_ablation_advise(const struct neph_ablation_comparison *in_preset);

/* Whether the takes that were asked for have the measure. */
bool neph_ablation_has_measure(const struct neph_ablation *ablation, int measure);

/* A change of so many decades as people read it: "-12 %", "+0.4 %", "x16". */
enum { NEPH_ABLATION_CHANGE_SIZE = 24 };
void neph_ablation_change(double decades, char text[NEPH_ABLATION_CHANGE_SIZE]);

/* The chart of all parts and measures as one SVG image, 1,000 px wide. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_plot(const struct neph_ablation *ablation, FILE *out,
                                    struct neph_diag *diag);

#endif

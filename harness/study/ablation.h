/* SPDX-License-Identifier: MIT
 *
 * An ablation: the effect of each part of the real-time renderer on error, flicker, lag and cost.
 * It is a flicker study (flicker_study.h) of four kinds of configurations:
 *
 * - the preset;
 * - the preset without one part;
 * - the plain pipeline, which has none of the parts;
 * - the plain pipeline with one part only.
 */
#ifndef NEPH_HARNESS_STUDY_ABLATION_H
#define NEPH_HARNESS_STUDY_ABLATION_H

#include "harness/study/ablation_parts.h"
#include "harness/study/flicker_study.h"

#include <stdio.h>

/* A measured quantity. Smaller is better for all of them. */
struct neph_ablation_measure {
    const char *name;          /* in JSON, CSV and sentences */
    const char *column;        /* in narrow tables */
    const char *title;         /* in other tables and in charts */
    const char *metric, *mask; /* of neph_study_metrics; NULL: the measure is a cost */
    size_t cost;               /* offset in struct neph_study_cost */
    bool is_time;              /* a time: printed, without influence on the advice */
};
enum { NEPH_ABLATION_MEASURES_MAX = 8 };

/* Ends with a NULL name. */
extern const struct neph_ablation_measure neph_ablation_measures[];
int neph_ablation_measure_count(void);

/* The pipeline in which a part is switched. */
enum neph_ablation_place {
    NEPH_ABLATION_IN_PRESET, /* the preset, and the preset without the part */
    NEPH_ABLATION_ALONE,     /* the plain pipeline with the part (and the parts it needs), and
                                without it */
    NEPH_ABLATION_PLACES,
};

/* Verdict on a change. "Nothing" means less than 5 % either way, a chosen limit below which a part
 * is hardly worth keeping. */
enum neph_ablation_verdict {
    NEPH_ABLATION_NO_NUMBER,
    NEPH_ABLATION_SAME,    /* no change in any scene */
    NEPH_ABLATION_NOTHING, /* the interval lies within 5 % */
    NEPH_ABLATION_BUYS,    /* the measure falls; p after Holm over the family is below 0.05 */
    NEPH_ABLATION_MAY_BUY, /* the interval lies below 0, but Holm's p is not below 0.05 */
    NEPH_ABLATION_COSTS,   /* the measure rises, as above */
    NEPH_ABLATION_MAY_COST,
    NEPH_ABLATION_UNDECIDED, /* too few scenes, or they disagree */
    NEPH_ABLATION_VERDICTS,
};
extern const char *const neph_ablation_verdict_words[NEPH_ABLATION_VERDICTS];

/* log10(1.05) */
#define NEPH_ABLATION_NOTHING_DECADES 0.0211892990699381

/* Change of a measure with the part, relative to without, in decades: negative means better. Seeds
 * of a scene are averaged; the scenes are the sample. */
struct neph_ablation_effect {
    const double *scenes; /* one value for each scene of the study; NaN: none; in the ablation's
                             arena */
    int scene_count;      /* scenes with a value */
    double mean;          /* NaN: no scene has a value */
    bool has_interval;
    double low, high; /* 95 %, Student's t over scenes */
    double p, p_holm; /* two-sided; 1 without a test */
    int better, worse, alike;
    int best_scene, worst_scene; /* with the largest fall and the largest rise; -1: none */
    enum neph_ablation_verdict verdict;
};

/* A part in a place, or all parts at once: the preset against the plain pipeline. */
struct neph_ablation_comparison {
    int part; /* -1: all parts */
    enum neph_ablation_place place;
    int with, without; /* configurations, as indices of the study's presets */
    struct neph_ablation_effect effects[NEPH_ABLATION_MEASURES_MAX];
};

struct neph_ablation {
    const char *preset;                          /* borrowed */
    struct neph_arena arena;                     /* owns all texts and changes */
    neph_ablation_set parts;                     /* parts of the preset */
    neph_ablation_set asked;                     /* parts that are measured, a subset of `parts` */
    const char *values[NEPH_ABLATION_PARTS_MAX]; /* neph_ablation_part_values() */
    const char *words[NEPH_STUDY_PRESETS_MAX];   /* preset words of each configuration */
    const char *labels[NEPH_STUDY_PRESETS_MAX];  /* name of each configuration in the progress */
    neph_ablation_set without[NEPH_STUDY_PRESETS_MAX];
    int configuration_count;
    struct neph_ablation_comparison comparisons[2 * NEPH_ABLATION_PARTS_MAX + 1];
    int comparison_count;
    struct neph_flicker_study study; /* over the configurations, after it has run */
    int judged_count;                /* size of Holm's family */
};

/* Plans the configurations of an ablation. `only`: names of parts; none given: all parts of the
 * preset. Initialise `ablation` with {0}; call neph_ablation_finish() in any case. NEPH_ERR_USAGE:
 * no such part or preset, or the preset does not have the part. */
enum neph_status neph_ablation_plan(const char *preset, const char *const *only, int only_count,
                                    struct neph_ablation *ablation, struct neph_diag *diag);

/* Computes all effects and verdicts from the study's results. NEPH_ERR_UNSUPPORTED: none of the
 * scenes could be rendered; NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_judge(struct neph_ablation *ablation, struct neph_diag *diag);

void neph_ablation_finish(struct neph_ablation *ablation);

/* The comparison of a part in a place, or of all parts (part -1); NULL: none. */
const struct neph_ablation_comparison *neph_ablation_find(const struct neph_ablation *ablation,
                                                          int part, enum neph_ablation_place place);

/* Advice for a preset, from a part's effects in it. */
enum neph_ablation_advice {
    NEPH_ABLATION_KEEP,       /* it improves a measure */
    NEPH_ABLATION_PERHAPS,    /* it may improve a measure */
    NEPH_ABLATION_UNCERTAIN,  /* at least one measure is undecided, and none improves */
    NEPH_ABLATION_LEAVE_OUT,  /* it improves no measure, and worsens one, or may do so */
    NEPH_ABLATION_LITTLE,     /* it changes no measure by 5 % */
    NEPH_ABLATION_IDLE,       /* it changes no value in any scene */
    NEPH_ABLATION_UNMEASURED, /* no scene has a value */
    NEPH_ABLATION_ADVICES,
};
extern const char *const neph_ablation_advice_words[NEPH_ABLATION_ADVICES];

/* Decides by the verdicts of all measures except times. */
enum neph_ablation_advice neph_ablation_advise(const struct neph_ablation_comparison *in_preset);

/* Whether the measured sequences include this measure. */
bool neph_ablation_has_measure(const struct neph_ablation *ablation, int measure);

/* The chart of all parts and measures as one SVG image, 1,000 px wide. Errors: NEPH_ERR_MEMORY. */
enum { NEPH_ABLATION_CHANGE_SIZE = 24 };
void neph_ablation_change(double decades, char text[NEPH_ABLATION_CHANGE_SIZE]);

/* Writes one SVG with a tornado chart for each measure, one below the other. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_plot(const struct neph_ablation *ablation, FILE *out,
                                    struct neph_diag *diag);

#endif

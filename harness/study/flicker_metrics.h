/* SPDX-License-Identifier: MIT
 *
 * What a flicker study measures, as tables: the takes that are made of a scene, the displays they
 * are looked at on, and the numbers that are read off them. A metric is a line.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_METRICS_H
#define NEPH_HARNESS_STUDY_FLICKER_METRICS_H

#include "scenes/variant.h"

#include <stdbool.h>

/* Frame of the step and of the cut: what was before has warmed up. */
enum { NEPH_STUDY_EVENT_FRAME = 32 };

/* Sequences that are rendered of a scene. */
enum neph_study_take_id {
    NEPH_STUDY_FLICKER, /* the scene as it is */
    NEPH_STUDY_STEP,    /* its sun grows brighter at once */
    NEPH_STUDY_SINE,    /* its sun swings */
    NEPH_STUDY_CUT,     /* its camera jumps */
    NEPH_STUDY_TAKES,
};

struct neph_study_take {
    const char *name;               /* of the command line */
    enum neph_variant_kind variant; /* NEPH_VARIANT_KIND_COUNT: the scene itself */
    int frame_count;                /* 0: as many as were asked for */
    const char *const *extractors;  /* NULL-terminated */
    const char *const *settings;    /* of the extractors; NULL: none */
};
extern const struct neph_study_take neph_study_takes[NEPH_STUDY_TAKES];

/* NEPH_STUDY_TAKES: there is none of that name. */
int neph_study_take_find(const char *name);

/* The displays at which rankings have to hold; the first is the one of all other numbers. */
struct neph_study_display {
    double frame_rate_hz, pixels_per_degree;
};
enum { NEPH_STUDY_DISPLAYS = 6 };
extern const struct neph_study_display neph_study_displays[NEPH_STUDY_DISPLAYS];

/* Extractors whose numbers depend on the display, NULL-terminated. */
extern const char *const neph_study_eye_extractors[];

/* A number of a take. Of all of them less is better. */
struct neph_study_metric {
    const char *title; /* with the unit */
    enum neph_study_take_id take;
    const char *metric, *mask; /* of radiance */
    double scale;              /* of tables and texts */
    double floor;              /* what is below is alike, in units of the metric */
    const char *alone; /* the same number of the reference alone, which must not be above a third
                          (metrics/extractors/flicker_verdict.h); NULL: there is none */
    const char *never_share; /* share of pixels that never settle: above 5 % the number is none */
    const char *at_most;     /* what it is a part of, in the same mask: the bound that stands for it
                                where it cannot be told from the rest; NULL: nothing does */
    bool of_the_eye;         /* also read at the other displays */
};

/* Ends with a NULL title. */
extern const struct neph_study_metric neph_study_metrics[];
enum { NEPH_STUDY_METRICS_MAX = 32 };
int neph_study_metric_count(void);

/* Index of a metric of this name and mask, which has to be there. */
int neph_study_metric_find(const char *metric, const char *mask);

/* Indices of the table: the first of the eye, which rankings go by, and the first of the step, the
 * lag that it stands beside. */
int neph_study_headline(void);
int neph_study_lag(void);

/* The share of pixels that may never settle for a time to count. */
#define NEPH_STUDY_NEVER_MOST 0.05

#endif

/* SPDX-License-Identifier: MIT
 *
 * The measurements of a flicker study as tables: the sequences rendered for a scene, the displays,
 * and the metrics. A new metric is one row.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_METRICS_H
#define NEPH_HARNESS_STUDY_FLICKER_METRICS_H

#include "scenes/variant.h"

#include <stdbool.h>

/* Frame of the step and of the camera cut, after the warm-up. */
enum { NEPH_STUDY_EVENT_FRAME = 32 };

/* Sequences rendered for a scene. */
enum neph_study_capture_id {
    NEPH_STUDY_FLICKER, /* the scene as it is */
    NEPH_STUDY_STEP,    /* the sun becomes brighter in one frame */
    NEPH_STUDY_SINE,    /* the sun's brightness swings */
    NEPH_STUDY_CUT,     /* the camera jumps */
    NEPH_STUDY_CAPTURES,
};

struct neph_study_capture {
    const char *name;               /* on the command line */
    enum neph_variant_kind variant; /* NEPH_VARIANT_KIND_COUNT: the scene itself */
    int frame_count;                /* 0: the requested number */
    const char *const *extractors;  /* NULL-terminated */
    const char *const *settings;    /* of the extractors; NULL: none */
};
extern const struct neph_study_capture neph_study_captures[NEPH_STUDY_CAPTURES];

/* Index of a sequence by name; NEPH_STUDY_CAPTURES: none. */
int neph_study_capture_find(const char *name);

/* The displays for which rankings are computed; all other values are for the first one. */
struct neph_study_display {
    double frame_rate_hz, pixels_per_degree;
};
enum { NEPH_STUDY_DISPLAYS = 6 };
extern const struct neph_study_display neph_study_displays[NEPH_STUDY_DISPLAYS];

/* Scenes with their own frame rates (0) are compared on all displays, scenes of one given rate only
 * on two displays of this rate. */
int neph_study_display_count(double frame_rate_hz);
struct neph_study_display neph_study_display_at(double frame_rate_hz, int index);

/* Extractors whose values depend on the display, NULL-terminated. */
extern const char *const neph_study_eye_extractors[];

/* A metric of a sequence. Smaller is better for all of them. */
struct neph_study_metric {
    const char *title; /* with the unit */
    enum neph_study_capture_id take;
    const char *metric, *mask; /* of the radiance */
    double scale;              /* factor in tables and texts */
    double least;              /* values below it count as equal; in units of the metric */
    const char *alone; /* the same metric of the reference by itself; above a third of the value the
                          value does not count (metrics/extractors/flicker_verdict.h); NULL: none */
    const char *never_share; /* share of pixels that never settle; above 5 % the value does not
                                count */
    const char *at_most;     /* upper bound in the same mask, the whole of which the metric is a
                                part; replaces a value that is not measurable; NULL: none */
    bool of_the_eye;         /* evaluated for the other displays, too */
    const char *name;        /* in the answer, of a ratio to the floor; NULL: only in the tables */
};

/* Ends with a NULL title. */
extern const struct neph_study_metric neph_study_metrics[];
enum { NEPH_STUDY_METRICS_MAX = 32 };
int neph_study_metric_count(void);

/* Index of a metric by name and mask; the metric must exist. */
int neph_study_metric_find(const char *metric, const char *mask);

/* Index of the metric that ranks presets, the first of the eye; and of the lag shown beside it, the
 * first of the step. */
int neph_study_find_headline(void);
int neph_study_find_lag(void);

/* The largest share of pixels that never settle for which a time counts. */
#define NEPH_STUDY_NEVER_MOST 0.05

#endif

/* SPDX-License-Identifier: MIT
 *
 * Stress tests of methods that reuse rays and frames: the expected failure in a scene, the measures
 * of a sequence, and their limits, each with its reason. Written in the scene's file under
 * `failure`; no rendered value depends on it.
 *
 * A sweep is a product of axes; each axis replaces numbers of the file by its values. Point 0 is
 * the file as it is; the others are the product, the first axis slowest.
 */
#ifndef NEPH_SCENES_FAILING_H
#define NEPH_SCENES_FAILING_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* Measures of a sequence; harness/stress/measures.h defines them. Smaller is better for all of
 * them. */
enum neph_failing_measure {
    NEPH_FAILING_ERROR,
    NEPH_FAILING_FLICKER,
    NEPH_FAILING_PERIOD_4,
    NEPH_FAILING_LAG,
    NEPH_FAILING_EDGE_RATIO,
    NEPH_FAILING_NEVER_SEEN,
    NEPH_FAILING_ENERGY,
    NEPH_FAILING_BAD_VALUES,
    NEPH_FAILING_MEASURES,
};

enum neph_failing_reference {
    NEPH_FAILING_MARCH, /* the march of the same frame with the same steps and many rays a pixel */
    NEPH_FAILING_EXACT, /* engine exact, through centres of pixels */
    NEPH_FAILING_REFERENCE_COUNT,
};

struct neph_failing_limit {
    enum neph_failing_measure measure;
    const char *over; /* the mask, "all" */
    double limit;     /* value <= limit passes */
    const char *reason;
    int line; /* in the scene file */
};

enum { NEPH_FAILING_VALUES_MAX = 16 };

/* Numbers of the file that an axis changes together. */
struct neph_failing_axis {
    const char *name;                   /* "pitch_m" */
    const char *paths;                  /* "solids[0].fence.pitch_m"; separated by spaces */
    int to_count, by_count;             /* one of them is 0 */
    double to[NEPH_FAILING_VALUES_MAX]; /* replace the numbers */
    double by[NEPH_FAILING_VALUES_MAX]; /* added to the numbers */
};

struct neph_failing {
    const char *fails;   /* the failure and its cause; NULL: the scene has no stress test */
    const char *known;   /* renderers that are known to fail */
    const char *symptom; /* the visible symptom */
    const char *presets; /* names separated by spaces, "" for all */
    int width_px, height_px, frame_count, steps; /* at which the limits are defined */
    int event_frame; /* frame of the scene's event, for lags; 0: no event */
    enum neph_failing_reference truth;
    bool quick;   /* in the quick tier */
    bool engines; /* also tests engines without history, with engine exact as reference */
    int limit_count;
    struct neph_failing_limit *limits;
    int axis_count;
    struct neph_failing_axis *axes;
};

const char *neph_failing_measure_name(enum neph_failing_measure measure);
const char *neph_failing_reference_name(enum neph_failing_reference truth);

/* Number of values of an axis. */
int neph_failing_axis_count(const struct neph_failing_axis *axis);

/* Number of points of the sweep, with the file itself: 1 without axes. */
int neph_failing_point_count(const struct neph_failing *failing);

/* Index of the value of axis `axis` at point `point` > 0. */
int neph_failing_value_index(const struct neph_failing *failing, int point, int axis);

enum { NEPH_FAILING_POINT_SIZE = 160 };

/* "pitch_m=0.16 turn_deg=45", "" for point 0; truncated to `size`. */
void neph_failing_point_name(const struct neph_failing *failing, int point, char *text,
                             size_t size);

#endif

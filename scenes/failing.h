/* SPDX-License-Identifier: MIT
 *
 * How methods that reuse rays and frames fail in a scene: what fails and for whom, what is measured
 * of a sequence, and the limits, each with its reason. Written in the scene's file under `failure`;
 * nothing of it changes a rendered value.
 *
 * A sweep is a product of axes, each of which writes its values in place of numbers of the file.
 * Point 0 is the file as it is; the others are the product, the first axis slowest.
 */
#ifndef NEPH_SCENES_FAILING_H
#define NEPH_SCENES_FAILING_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* What of a sequence is judged; harness/stress/measures.h says how each is measured. Of all of
 * them less is better. */
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

enum neph_failing_truth {
    NEPH_FAILING_MARCH, /* the march of the same moment with the same steps, many rays a pixel */
    NEPH_FAILING_EXACT, /* engine exact, through centres of pixels */
    NEPH_FAILING_TRUTH_COUNT,
};

struct neph_failing_limit {
    enum neph_failing_measure measure;
    const char *over; /* the mask, "all" */
    double limit;     /* value <= limit passes */
    const char *reason;
    int line; /* in the scene file */
};

enum { NEPH_FAILING_VALUES_MAX = 16 };

/* Numbers of the file that change together. */
struct neph_failing_axis {
    const char *name;                   /* "pitch_m" */
    const char *paths;                  /* "solids[0].fence.pitch_m", several parted by spaces */
    int to_count, by_count;             /* one of them is 0 */
    double to[NEPH_FAILING_VALUES_MAX]; /* in place of the numbers */
    double by[NEPH_FAILING_VALUES_MAX]; /* added to the numbers */
};

struct neph_failing {
    const char *fails;   /* what fails and why; NULL: the scene says nothing of failures */
    const char *known;   /* who is known to fail */
    const char *symptom; /* what is seen of it */
    const char *presets; /* names parted by spaces, "" for all */
    int width_px, height_px, frame_count, steps; /* what the limits hold at */
    int event_frame; /* of what happens in the scene, for lags; 0: nothing does */
    enum neph_failing_truth truth;
    bool quick;   /* one of the quick tier */
    bool engines; /* also of engines that make each picture anew, against engine exact */
    int limit_count;
    struct neph_failing_limit *limits;
    int axis_count;
    struct neph_failing_axis *axes;
};

const char *neph_failing_measure_name(enum neph_failing_measure measure);
const char *neph_failing_truth_name(enum neph_failing_truth truth);

/* How many values an axis has. */
int neph_failing_axis_count(const struct neph_failing_axis *axis);

/* Points of the sweep, the file as it is included: 1 without axes. */
int neph_failing_point_count(const struct neph_failing *failing);

/* Which value of axis `axis` point `point` > 0 has. */
int neph_failing_value_index(const struct neph_failing *failing, int point, int axis);

enum { NEPH_FAILING_POINT_SIZE = 160 };

/* "pitch_m=0.16 turn_deg=45", "" of point 0; what does not fit is cut off. */
void neph_failing_point_name(const struct neph_failing *failing, int point, char *text,
                             size_t size);

#endif

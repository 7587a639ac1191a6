/* SPDX-License-Identifier: MIT
 *
 * What a picture costs against how much there is of it: pixels, steps, voxels, optical depth and
 * pictures in a row, each by itself, with the exponents that come of it and those that ought to.
 * Density evaluations are counted and the same on every device; times are those of one.
 */
#ifndef NEPH_HARNESS_SWEEP_SCALING_H
#define NEPH_HARNESS_SWEEP_SCALING_H

#include "harness/json.h"
#include "harness/run/store.h"
#include "harness/run/times.h"

/* --- exponents ------------------------------------------------------------------------------ */

/* cost ~ x^value. NaN: fewer than three points with a logarithm, or all at one x. The interval is
 * Student's, 95 %, of the scatter about the line: of what is counted it says how straight that is.
 */
struct neph_exponent {
    double value, low, high;
    int count; /* points in it */
};

/* The straight line through the logarithms of least squares. Points whose x or y is not above 0 are
 * left out. */
struct neph_exponent neph_exponent_fit(const double *x, const double *y, int count);

/* Exponents that are as they should be; `low` may be -INFINITY. */
struct neph_exponent_range {
    double low, high;
};

/* Exponents that differ by less are called the same: a factor of 1.26 over a decade. */
#define NEPH_EXPONENT_SAME 0.1

enum neph_exponent_verdict {
    NEPH_EXPONENT_NONE,     /* there is no exponent */
    NEPH_EXPONENT_EXPECTED, /* the interval lies within the range, NEPH_EXPONENT_SAME wider */
    NEPH_EXPONENT_OTHER,    /* it lies outside */
    NEPH_EXPONENT_UNTOLD,   /* it is wider than that */
    NEPH_EXPONENT_VERDICTS,
};
extern const char *const neph_exponent_verdict_words[NEPH_EXPONENT_VERDICTS];

enum neph_exponent_verdict neph_exponent_judge(const struct neph_exponent *exponent,
                                               struct neph_exponent_range range);

/* --- the whole ------------------------------------------------------------------------------ */

struct neph_scaling_params {
    const char *scene;       /* a name of the catalogue, or a path */
    const char *preset;      /* of realtime, beside the march: "NAME" or "NAME+KEY=VALUE+..." */
    int width_px, height_px; /* the largest */
    int seed, jobs;          /* jobs: processes that render what is counted; 0: one */
    bool untimed, quiet;
    struct neph_times *times;          /* NULL when untimed */
    bool retimes;                      /* what was timed before is timed again */
    struct neph_shared_device *device; /* as neph_shot.device */
};

enum neph_scaling_axis_id {
    NEPH_SCALING_PIXELS,
    NEPH_SCALING_STEPS,
    NEPH_SCALING_VOXELS,
    NEPH_SCALING_DEPTH,
    NEPH_SCALING_PICTURES,
    NEPH_SCALING_AXES,
};

enum { NEPH_SCALING_VALUES_MAX = 6, NEPH_SCALING_SERIES = 2 };

struct neph_scaling_axis {
    const char *name, *title;
    double values[NEPH_SCALING_VALUES_MAX]; /* ends with a 0, or is full */
    struct neph_exponent_range work, time;  /* as they ought to be */
    const char *reason;                     /* of both */
};
extern const struct neph_scaling_axis neph_scaling_axes[NEPH_SCALING_AXES];
int neph_scaling_value_count(const struct neph_scaling_axis *axis);

struct neph_scaling_point {
    double x;                /* pixels, steps, voxels, a factor of all extinctions, pictures */
    double evaluations;      /* of density, of a picture or of all of them; NaN: not counted */
    struct neph_spread time; /* likewise [s]; NaN: not timed */
};

struct neph_scaling_line {
    enum neph_scaling_axis_id axis;
    int series;
    char missing[256]; /* why there is none; "" */
    struct neph_scaling_point points[NEPH_SCALING_VALUES_MAX];
    int count;
    struct neph_exponent work, time;
    enum neph_exponent_verdict work_verdict, time_verdict;
};

struct neph_scaling {
    char scene[64], scene_hash[NEPH_HASH_HEX_SIZE], device[128];
    int width_px, height_px; /* of the largest picture */
    char series[NEPH_SCALING_SERIES][256];
    struct neph_scaling_line lines[NEPH_SCALING_AXES * NEPH_SCALING_SERIES];
    int line_count;
    bool has_closed_form; /* engine exact marches no ray in it, whatever there is of it */
};

/* Frames go through the store, times into params->times. NEPH_ERR_USAGE: there is no such preset;
 * NEPH_ERR_UNAVAILABLE: there is no device; NEPH_ERR_INTERRUPTED: what is finished stays. */
enum neph_status neph_scaling_run(const struct neph_scaling_params *params,
                                  struct neph_store *store, struct neph_scaling *scaling,
                                  struct neph_diag *diag);

/* Exponents and verdicts from the points. */
void neph_scaling_judge(struct neph_scaling *scaling);

/* The JSON of an earlier run, {"format": "neph-scaling-1", ...}, docs/sweep.md; to json_decref.
 * NEPH_ERR_INPUT: the file holds none. */
enum neph_status neph_scaling_load(const char *path, json_t **document, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Cost of a frame over problem size: pixels, steps, voxels, density and frames in a row, each
 * varied by itself, with the fitted and the expected exponents. Density evaluations are counted and
 * equal on every device; times are measured on one device.
 */
#ifndef NEPH_HARNESS_SWEEP_SCALING_H
#define NEPH_HARNESS_SWEEP_SCALING_H

#include "harness/json.h"
#include "harness/run/store.h"
#include "harness/run/times.h"

/* --- exponents ------------------------------------------------------------------------------ */

/* cost ~ x^value. NaN: fewer than three usable points, or all at one x. The interval is Student's
 * 95 % from the scatter about the line; for counted work, which has no noise, it shows the
 * deviation from a power law. */
struct neph_exponent {
    double value, low, high;
    int count; /* number of points used */
};

/* Least-squares line through the logarithms. Points with x or y of 0 or less are skipped. */
struct neph_exponent neph_exponent_fit(const double *x, const double *y, int count);

/* Expected exponents; `low` may be -INFINITY. */
struct neph_exponent_range {
    double low, high;
};

/* Exponents that differ by less count as equal: a factor of 1.26 over a decade. */
#define NEPH_EXPONENT_SAME 0.1

enum neph_exponent_verdict {
    NEPH_EXPONENT_NONE,     /* no exponent */
    NEPH_EXPONENT_EXPECTED, /* the interval is within the range, widened by NEPH_EXPONENT_SAME */
    NEPH_EXPONENT_OTHER,    /* the interval is outside of it */
    NEPH_EXPONENT_UNTOLD,   /* the interval overlaps its edge */
    NEPH_EXPONENT_VERDICTS,
};
extern const char *const neph_exponent_verdict_words[NEPH_EXPONENT_VERDICTS];

/* Compares the interval of an exponent with the expected range. */
enum neph_exponent_verdict neph_exponent_judge(const struct neph_exponent *exponent,
                                               struct neph_exponent_range range);

/* --- the whole ------------------------------------------------------------------------------ */

struct neph_scaling_params {
    const char *scene;       /* a name of the catalogue, or a path */
    const char *preset;      /* of realtime, beside the marcher: "NAME" or "NAME+KEY=VALUE+..." */
    int width_px, height_px; /* largest size */
    int seed, jobs;          /* jobs: processes that render the counted frames; 0: one */
    bool untimed, quiet;
    struct neph_times *times;          /* NULL when untimed */
    bool retimes;                      /* time again what was timed before */
    struct neph_shared_device *device; /* like neph_shot.device */
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
    double values[NEPH_SCALING_VALUES_MAX]; /* ends with a 0 unless it is full */
    struct neph_exponent_range work, time;  /* expected exponents */
    const char *reason;                     /* reason for both */
};
extern const struct neph_scaling_axis neph_scaling_axes[NEPH_SCALING_AXES];
int neph_scaling_value_count(const struct neph_scaling_axis *axis);

struct neph_scaling_point {
    double x;                /* pixels, steps, voxels, factor of all extinctions, or frames */
    double evaluations;      /* density evaluations of a frame, or of all frames in a row; NaN: not
                                counted */
    struct neph_spread time; /* of the same [s]; NaN: not timed */
};

struct neph_scaling_line {
    enum neph_scaling_axis_id axis;
    int series;
    char missing[256]; /* reason why there are no points; "" */
    struct neph_scaling_point points[NEPH_SCALING_VALUES_MAX];
    int count;
    struct neph_exponent work, time;
    enum neph_exponent_verdict work_verdict, time_verdict;
};

struct neph_scaling {
    char scene[64], scene_hash[NEPH_HASH_HEX_SIZE], device[128];
    int width_px, height_px; /* of the largest frame */
    char series[NEPH_SCALING_SERIES][256];
    struct neph_scaling_line lines[NEPH_SCALING_AXES * NEPH_SCALING_SERIES];
    int line_count;
    bool has_closed_form; /* `exact` has a closed form: its cost does not depend on the sizes */
};

/* Runs all axes. Frames go through the store, times into params->times. NEPH_ERR_USAGE: no such
 * preset; NEPH_ERR_UNAVAILABLE: no device; NEPH_ERR_INTERRUPTED: finished frames stay in the store.
 */
enum neph_status neph_scaling_run(const struct neph_scaling_params *params,
                                  struct neph_store *store, struct neph_scaling *scaling,
                                  struct neph_diag *diag);

/* Computes exponents and verdicts from the points. */
void neph_scaling_judge(struct neph_scaling *scaling);

/* Reads the JSON of an earlier run, {"format": "neph-scaling-1", ...} (docs/sweep.md), for
 * json_decref(). NEPH_ERR_INPUT: another file. */
enum neph_status neph_scaling_load(const char *path, json_t **document, struct neph_diag *diag);

#endif

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
#include "harness/sweep/exponent.h"
#include "harness/sweep/times.h"

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

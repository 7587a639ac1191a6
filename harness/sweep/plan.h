/* SPDX-License-Identifier: MIT
 *
 * The plan of a sweep, from a YAML file: series, each an engine with one setting that varies from
 * point to point. A series is a line in the charts.
 */
#ifndef NEPH_HARNESS_SWEEP_PLAN_H
#define NEPH_HARNESS_SWEEP_PLAN_H

#include "base/option.h"
#include "harness/engines/engine.h"

#include <stdbool.h>
#include <stdio.h>

enum {
    NEPH_SWEEP_SERIES_MAX = 48,
    NEPH_SWEEP_VALUES_MAX = 16,
    NEPH_SWEEP_POINTS_MAX = NEPH_SWEEP_SERIES_MAX * NEPH_SWEEP_VALUES_MAX,
    NEPH_SWEEP_LABEL_SIZE = 80,
    NEPH_SWEEP_FRAMES_MIN = 16, /* of a sequence, without its warm-up */
    NEPH_SWEEP_SEEDS_MAX = 16,  /* of a sequence */
};

/* Texts are in the plan's arena. */
struct neph_sweep_series {
    const char *name;   /* in tables and legends, unique */
    const char *engine; /* one of neph_engines */
    const char *preset; /* "NAME" or "NAME+KEY=VALUE+..."; NULL: none */
    const char *held;   /* settings "KEY=VALUE KEY=VALUE" of all points; NULL: none */
    const char *varied; /* the setting that varies; NULL: the series is one point */
    const char *values; /* its values, separated by spaces, in the order of the line */
    bool flicker; /* render sequences and measure their flicker, as for engines with a history */
    /* values of `varied` for which a sequence with a step of the sun is measured, too; NULL:
     * none */
    const char *lag_at;
    int scattering; /* scattering of the rendered scene: enum neph_scattering; -1: the scene's own
                       */
    double order;   /* expected order: error ~ time^-order; 0: not given */
};

struct neph_sweep_plan {
    struct neph_arena arena; /* owns texts and series */
    const char *title;
    const char *light; /* lighting of series that name none, in scenes of multiple scattering */
    int width_px, height_px;
    int frame_count;   /* of sequences; a multiple of 4 */
    int warm_up;       /* frames at the start that are not measured; a multiple of 4 */
    int truth_samples; /* paths per pixel of the ground truth, where that is the tracer */
    int round_count;   /* every point is timed once in each round */
    int seed_count;    /* of measured sequences; for single frames every round is a seed */
    struct neph_sweep_series *series;
    int series_count;
};

/* Reads a plan from a file, or one that is installed with neph (scenes/studies/NAME.yaml). All
 * names and values of all series are checked against the engines' tables. Errors have file, line
 * and column: NEPH_ERR_INPUT; NEPH_ERR_NOT_FOUND. Free with neph_sweep_plan_finish(). */
enum neph_status neph_sweep_plan_load(const char *path_or_name, struct neph_sweep_plan *plan,
                                      struct neph_diag *diag);
void neph_sweep_plan_finish(struct neph_sweep_plan *plan);

/* The number of points of a series, and the setting of a point: "steps=32"; "" for a series of one
 * point. */
int neph_sweep_value_count(const struct neph_sweep_series *series);
void neph_sweep_value(const struct neph_sweep_series *series, int index,
                      char label[NEPH_SWEEP_LABEL_SIZE]);

/* Whether the lag of this point is measured. */
bool neph_sweep_has_lag(const struct neph_sweep_series *series, int index);

/* The scattering with which a series renders the scene. */
enum neph_scattering neph_sweep_scattering(const struct neph_sweep_series *series,
                                           const struct neph_scene *scene);

/* The engine of a series in a scene. For multiple scattering "march" becomes march_LIGHT with the
 * plan's lighting; "realtime" gets the lighting as a setting. */
const struct neph_engine *neph_sweep_engine(const struct neph_sweep_plan *plan,
                                            const struct neph_sweep_series *series,
                                            enum neph_scattering scattering);

/* The settings of a point. NEPH_ERR_USAGE as of neph_settings_set(). */
enum neph_status neph_sweep_settings(const struct neph_sweep_plan *plan,
                                     const struct neph_sweep_series *series, int index,
                                     enum neph_scattering scattering,
                                     struct neph_settings *settings, struct neph_diag *diag);

/* Prints the keys of a plan as a Markdown table. */
void neph_sweep_plan_print_keys(FILE *file);

#endif

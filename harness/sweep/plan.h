/* SPDX-License-Identifier: MIT
 *
 * What a sweep renders, from a YAML file: series, each an engine with one setting that changes
 * from point to point. A series is a line on the charts.
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
    NEPH_SWEEP_FRAMES_MIN = 16, /* of a sequence, warm-up left out */
    NEPH_SWEEP_SEEDS_MAX = 16,  /* of a sequence */
};

/* Texts are of the arena of the plan. */
struct neph_sweep_series {
    const char *name;   /* in tables and legends, unique */
    const char *engine; /* one of neph_engines */
    const char *preset; /* "NAME" or "NAME+KEY=VALUE+..."; NULL: none */
    const char *held;   /* settings "KEY=VALUE KEY=VALUE" of all its points; NULL: none */
    const char *varied; /* the setting that changes; NULL: the series is one point */
    const char *values; /* what it is set to, parted by spaces, in the order of the line */
    bool flicker; /* rendered as a sequence, as what has a history is, and its flicker measured */
    const char
        *lag_at; /* values of `varied` at which that is done again with a step of the sun; NULL: at
                     none */
    int scattering; /* the scene as if it had these orders of scattering: enum neph_scattering; -1:
                       those that it has */
    double order;   /* error ~ time^-order where it works as it should; 0: nobody says */
};

struct neph_sweep_plan {
    struct neph_arena arena; /* of texts and series */
    const char *title;
    const char *light; /* the lighting of series that name none, in scenes of multiple scattering */
    int width_px, height_px;
    int frame_count;   /* of sequences; a multiple of 4 */
    int warm_up;       /* the first of them, which are not measured; a multiple of 4 */
    int truth_samples; /* paths per pixel of the reference, where that is the tracer */
    int round_count;   /* in which every point is timed once */
    int seed_count;    /* of sequences that are measured; rounds are seeds of other pictures */
    struct neph_sweep_series *series;
    int series_count;
};

/* Read a plan from a file, or the one of that name that comes with neph (scenes/studies/NAME.yaml).
 * Every word and value of every series is checked against the tables of the engines. Errors name
 * file, line and column: NEPH_ERR_INPUT; NEPH_ERR_NOT_FOUND. Free with _finish. */
enum neph_status neph_sweep_plan_load(const char *path_or_name, struct neph_sweep_plan *plan,
                                      struct neph_diag *diag);
void neph_sweep_plan_finish(struct neph_sweep_plan *plan);

/* How many points a series has, and what the setting of one is: "steps=32"; "" where nothing
 * changes. */
int neph_sweep_value_count(const struct neph_sweep_series *series);
void neph_sweep_value(const struct neph_sweep_series *series, int index,
                      char label[NEPH_SWEEP_LABEL_SIZE]);

/* Whether the lag of that point is measured. */
bool neph_sweep_has_lag(const struct neph_sweep_series *series, int index);

/* The orders of scattering that a series has of a scene. */
enum neph_scattering neph_sweep_scattering(const struct neph_sweep_series *series,
                                           const struct neph_scene *scene);

/* The engine of a series in a scene: of single scattering that which it names. Where a scene has
 * all orders, "march" is the march of the plan's light, as "realtime" gets it as a setting. */
const struct neph_engine *neph_sweep_engine(const struct neph_sweep_plan *plan,
                                            const struct neph_sweep_series *series,
                                            enum neph_scattering scattering);

/* The settings of a point there. NEPH_ERR_USAGE as of neph_settings_set(). */
enum neph_status neph_sweep_settings(const struct neph_sweep_plan *plan,
                                     const struct neph_sweep_series *series, int index,
                                     enum neph_scattering scattering,
                                     struct neph_settings *settings, struct neph_diag *diag);

/* The keys of such a file as a table of Markdown. */
void neph_sweep_plan_print_keys(FILE *file);

#endif

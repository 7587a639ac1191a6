/* SPDX-License-Identifier: MIT
 *
 * A trial: a column of the stress tests at a point of a scenario, rendered, measured, judged, and
 * drawn where its verdicts need images.
 */
#ifndef NEPH_HARNESS_STRESS_TRIAL_H
#define NEPH_HARNESS_STRESS_TRIAL_H

#include "harness/json.h"
#include "harness/stress/results.h"
#include "harness/stress/truth.h"

/* Kinds of progress: frames of references, takes of presets, and of each engine its own. */
enum { NEPH_STRESS_KIND_REFERENCE, NEPH_STRESS_KIND_TAKE, NEPH_STRESS_KIND_ENGINE };

/* Shared by all trials of a run. */
struct neph_stress_bench {
    const struct neph_stress_params *params;
    struct neph_stress_suite *suite;
    struct neph_store *store;
    json_t *expectations;
    struct neph_progress progress;
    struct neph_engine_info infos[NEPH_STRESS_COLUMNS_MAX]; /* of the columns */
};

/* A point of a scenario, which is some rows in a row. */
struct neph_stress_point {
    const struct neph_scene *scene; /* as its file is */
    struct neph_scene *at;          /* at the point; owned */
    int first_row, row_count;
    struct neph_reference presets; /* of the presets, which march the same steps */
    struct neph_reference engines; /* of engine exact */
};

/* The point of a first row; its scene is not loaded. */
struct neph_stress_point neph_stress_point_at(const struct neph_stress_suite *suite, int row);

/* Whether any number of the point is measured of a column. */
bool neph_stress_has_trial(const struct neph_stress_suite *suite,
                           const struct neph_stress_point *point, int column);

/* "SCENARIO POINT, preset NAME". */
enum { NEPH_STRESS_NAME_SIZE = 256 };
void neph_stress_name(const struct neph_stress_suite *suite, const struct neph_stress_point *point,
                      int column, char name[NEPH_STRESS_NAME_SIZE]);

/* The kind of progress of a column's trials. */
int neph_stress_kind(const struct neph_stress_suite *suite, int column);

/* Fill the cells of a column. An engine that breaks or cannot render is in them; an error that ends
 * the run is returned. */
enum neph_status neph_stress_try(struct neph_stress_bench *bench, struct neph_stress_point *point,
                                 int column, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A trial: a column of the stress tests at a sweep point of a scenario. It is rendered, measured
 * and judged, and its evidence is drawn where the verdicts need it.
 */
#ifndef NEPH_HARNESS_STRESS_TRIAL_H
#define NEPH_HARNESS_STRESS_TRIAL_H

#include "harness/json.h"
#include "harness/stress/results.h"
#include "harness/stress/truth.h"

/* Groups of progress steps: reference frames, sequences of presets, and one group for each engine.
 */
enum { NEPH_STRESS_KIND_REFERENCE, NEPH_STRESS_KIND_TAKE, NEPH_STRESS_KIND_ENGINE };

/* State that all trials of a run share. */
struct neph_stress_context {
    const struct neph_stress_params *params;
    struct neph_stress_suite *suite;
    struct neph_store *store;
    json_t *expectations;
    struct neph_progress progress;
    struct neph_engine_info infos[NEPH_STRESS_TRIAL_COLUMNS_MAX]; /* of the columns */
};

/* A sweep point of a scenario: consecutive rows of the suite. */
struct neph_stress_point {
    const struct neph_scene *scene; /* as in its file */
    struct neph_scene *at;          /* the scene at the point; owned */
    int first_row, row_count;
    struct neph_reference presets; /* reference of presets, all of which have the same steps */
    struct neph_reference engines; /* reference of engines: frames of `exact` */
};

/* The point of a first row; its scene is not loaded yet. */
struct neph_stress_point neph_stress_point_at(const struct neph_stress_suite *suite, int row);

/* Whether any value of the point is measured in a column. */
bool neph_stress_has_trial(const struct neph_stress_suite *suite,
                           const struct neph_stress_point *point, int column);

/* Writes "SCENARIO POINT, preset NAME". */
enum { NEPH_STRESS_NAME_SIZE = 256 };
void neph_stress_name(const struct neph_stress_suite *suite, const struct neph_stress_point *point,
                      int column, char name[NEPH_STRESS_NAME_SIZE]);

/* The group of progress steps of a column's trials. */
int neph_stress_kind(const struct neph_stress_suite *suite, int column);

/* Runs a trial and fills its cells. An engine that fails or cannot render is noted in the cells; an
 * error that ends the run is returned. */
enum neph_status neph_stress_try(struct neph_stress_context *bench, struct neph_stress_point *point,
                                 int column, struct neph_diag *diag);

#endif

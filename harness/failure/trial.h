/* SPDX-License-Identifier: MIT
 *
 * A trial: a column of the failure suite at a point of a scenario, rendered, measured, judged, and
 * drawn where its verdicts want pictures.
 */
#ifndef NEPH_HARNESS_FAILURE_TRIAL_H
#define NEPH_HARNESS_FAILURE_TRIAL_H

#include "harness/failure/results.h"
#include "harness/failure/truth.h"
#include "harness/json.h"

/* Kinds of progress: pictures of references, takes of presets, and of each engine its own. */
enum { NEPH_FAILURE_KIND_REFERENCE, NEPH_FAILURE_KIND_TAKE, NEPH_FAILURE_KIND_ENGINE };

/* What all trials of a run share. */
struct neph_failure_bench {
    const struct neph_failure_params *params;
    struct neph_failure_suite *suite;
    struct neph_store *store;
    json_t *expectations;
    struct neph_progress progress;
    struct neph_engine_info infos[NEPH_FAILURE_COLUMNS_MAX]; /* of the columns */
};

/* A point of a scenario, which is some rows in a row. */
struct neph_failure_point {
    const struct neph_scene *scene; /* as its file is */
    struct neph_scene *at;          /* at the point; owned */
    int first_row, row_count;
    struct neph_reference presets; /* of the presets, which march the same steps */
    struct neph_reference engines; /* of engine exact */
};

/* The point whose first row it is; nothing is loaded. */
struct neph_failure_point neph_failure_point_at(const struct neph_failure_suite *suite, int row);

/* Whether anything of the point is asked of a column. */
bool neph_failure_is_asked(const struct neph_failure_suite *suite,
                           const struct neph_failure_point *point, int column);

/* "SCENARIO POINT, preset NAME". */
enum { NEPH_FAILURE_NAME_SIZE = 256 };
void neph_failure_name(const struct neph_failure_suite *suite,
                       const struct neph_failure_point *point, int column,
                       char name[NEPH_FAILURE_NAME_SIZE]);

/* The kind of progress of a column's trials. */
int neph_failure_kind(const struct neph_failure_suite *suite, int column);

/* Fill the cells of a column. What breaks or cannot be rendered is in them; what ends the run is
 * returned. */
enum neph_status neph_failure_try(struct neph_failure_bench *bench,
                                  struct neph_failure_point *point, int column,
                                  struct neph_diag *diag);

#endif

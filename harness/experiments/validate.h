/* SPDX-License-Identifier: MIT
 *
 * `neph validate` is several experiments on one request: --suite names the one that is run.
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_VALIDATE_H
#define NEPH_HARNESS_EXPERIMENTS_VALIDATE_H

#include "harness/experiment/experiment.h"
#include "harness/report/charts.h"
#include "harness/report/report.h"
#include "harness/report/validate.h"
#include "harness/stress/page.h"

struct neph_validate_request {
    struct neph_cli_shared shared; /* operands: scenes */
    struct neph_cli_list engines, only, presets;
    const char *tier, *suite, *pictures, *junit;
    int budget_s, samples, page_limit_mb, seed;
    bool no_charts, on_device, only_engine;
    /* Opened by `prepare`, closed by `finish`. */
    char *page_folder;
    struct neph_report *report;   /* of the catalogue and of the physics suite */
    struct neph_stress_page page; /* of the stress tests */
};

/* How much of the main job is run. */
struct neph_validate_tier {
    const char *name;
    const struct neph_scene_plan *scenes; /* of the catalogue, the last without a name; NULL: all of
                                             it, alike */
    const char *const *engines; /* NULL-terminated; NULL: every engine that is no shortcut */
    int width_px, height_px;    /* of the scenes' frames */
    double budget_s;            /* of each frame of an external renderer */
    const char *const *charts;  /* ids, NULL-terminated; NULL: all */
    int chart_repeats;          /* renders of each point of a chart */
    bool with_times;            /* the speeds of the scenes' frames are measured, too */
};

extern const struct neph_experiment neph_experiment_catalog;
extern const struct neph_experiment neph_experiment_physics;
extern const struct neph_experiment neph_experiment_stress;
/* For --suite failure, the name of the stress tests until one release ago. */
extern const struct neph_experiment neph_experiment_stress_by_old_name;

/* The tier of a request, also of one without --tier. */
const struct neph_validate_tier *neph_validate_tier(const struct neph_validate_request *request);

/* The results that have pictures on the stress tests' page, by the word of the option;
 * NEPH_STRESS_PICTURES_COUNT: there is no such word. */
enum neph_stress_pictures neph_stress_pictures_of(const char *word);

/* ---- of the catalogue and of the physics suite ----------------------------------------------- */

/* `prepare` and `finish` of these two: the report. */
enum neph_status neph_validate_open_report(void *request, struct neph_diag *diag);
void neph_validate_close_report(void *request);

/* A validation of the engines that the request names, of no scene yet. */
struct neph_validate_params neph_validate_params_of(const struct neph_validate_request *request,
                                                    const struct neph_experiment_run *run);

/* Show the report of a validation that ended with `status`, and publish its results and verdict.
 * The page of an interrupted run has the results so far. Returns `status`, or the page's own. */
enum neph_status neph_validate_publish(const struct neph_validate_request *request,
                                       struct neph_validation *validation,
                                       struct neph_publication *publication,
                                       enum neph_status status, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * `neph validate` consists of several experiments with one request; --suite selects the experiment.
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
    struct neph_report *report;   /* for the catalogue and the physics suite */
    struct neph_stress_page page; /* for the stress tests */
};

/* The extent of a run. */
struct neph_validate_tier {
    const char *name;
    const struct neph_scene_plan *scenes; /* of the catalogue, ends without a name; NULL: the whole
                                             catalogue, all scenes alike */
    const char *const *engines; /* NULL-terminated; NULL: every engine but the real-time methods */
    int width_px, height_px;    /* of the scenes' frames */
    double budget_s;            /* for each frame of an external renderer */
    const char *const *charts;  /* ids, NULL-terminated; NULL: all */
    int chart_repeats;          /* renders of each point of a chart */
    bool with_times;            /* measure the speeds of the scenes' frames as well */
    bool with_floors;           /* measure the floors of the presets over time as well */
};

extern const struct neph_experiment neph_experiment_catalog;
extern const struct neph_experiment neph_experiment_physics;
extern const struct neph_experiment neph_experiment_i3rc;
extern const struct neph_experiment neph_experiment_iprt;
extern const struct neph_experiment neph_experiment_stress;
/* For --suite failure, the previous release's name of the stress tests. */
extern const struct neph_experiment neph_experiment_stress_by_old_name;

/* The tier of a request, with or without --tier. */
const struct neph_validate_tier *neph_validate_tier(const struct neph_validate_request *request);

/* The selection of images on the stress tests' page, by the word of its option;
 * NEPH_STRESS_IMAGES_COUNT: unknown word. */
enum neph_stress_images neph_stress_images_parse(const char *word);

/* ---- catalogue and physics suite ------------------------------------------------------------- */

/* `prepare` and `finish` of these two experiments: open and close the report. */
enum neph_status neph_validate_open_report(void *request, struct neph_diag *diag);
void neph_validate_close_report(void *request);

/* Parameters of a validation with the request's engines, without scenes. */
struct neph_validate_params neph_validate_make_params(const struct neph_validate_request *request,
                                                      const struct neph_experiment_run *run);

/* Publish the report, the results and the verdict of a validation that ended with `status`. The
 * page of an interrupted run has the results so far. Returns `status`, or the error of
 * publishing. */
enum neph_status neph_validate_publish(const struct neph_validate_request *request,
                                       struct neph_validation *validation,
                                       struct neph_publication *publication,
                                       enum neph_status status, struct neph_diag *diag);

#endif

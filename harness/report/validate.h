/* SPDX-License-Identifier: MIT
 *
 * The main job: scenes over engines, measured against the highest rung of truth, with gates.
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATE_H
#define NEPH_HARNESS_REPORT_VALIDATE_H

#include "harness/report/validation.h"

/* Called with what there is whenever there is more to show. A status other than NEPH_OK ends the
 * run. */
typedef enum neph_status neph_validate_show(struct neph_validation *validation, void *context,
                                            struct neph_diag *diag);

struct neph_validate_params {
    const char *const *scenes; /* paths or names of the catalogue */
    int scene_count;
    const char *const *engines; /* names; engine_count 0: all that are no shortcut */
    int engine_count;
    const char *const *settings; /* "ENGINE:KEY=VALUE"; charts and the sequence have their own */
    int setting_count;
    int width_px, height_px;
    int seed;        /* the how-manieth of engines that draw paths, from 1 */
    double budget_s; /* of each picture of another project's renderer: see budget.h */
    struct neph_shared_device *device; /* as neph_shot.device */
    int jobs; /* processes that render scenes at the same time; results do not depend on it */
    bool quiet;
    bool skip_absent; /* a scene whose data is not there goes into `absent` */
    const struct neph_charts_params *charts; /* NULL: none */
    bool over_time;                          /* the sequence of over_time.h too */
    neph_validate_show *show;                /* NULL: nobody looks */
    void *context;
};

/* Run and measure. NEPH_OK also when gates failed: the verdict says so. `validation`, {0} before,
 * is for neph_validation_finish() in any case. With NEPH_ERR_INTERRUPTED too everything finished is
 * in it (when it has a title; else nothing had begun) and in the store, and a new run goes on from
 * there. */
enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               struct neph_validation *validation, struct neph_diag *diag);

#endif

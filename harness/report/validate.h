/* SPDX-License-Identifier: MIT
 *
 * The main job: scenes over engines, measured against the highest rung of truth, with gates. Its
 * result is one JSON document, from which alone the report is made (the form is written down in
 * scripts/report/README.md).
 */
#ifndef NEPH_HARNESS_REPORT_VALIDATE_H
#define NEPH_HARNESS_REPORT_VALIDATE_H

#include "harness/json.h"
#include "harness/report/charts.h"
#include "harness/run/store.h"

#include <stdbool.h>

/* Called with the document as it is whenever there is more to show. A status other than NEPH_OK
 * ends the run. */
typedef enum neph_status neph_validate_show(json_t *document, void *context,
                                            struct neph_diag *diag);

struct neph_validate_params {
    const char *const *scenes; /* paths or names of the catalogue */
    int scene_count;
    const char *const *engines; /* names; engine_count 0: all that are no shortcut */
    int engine_count;
    int width_px, height_px;
    int frame;       /* of every scene; the last frame of a shorter one */
    double budget_s; /* of each picture of another project's renderer: see budget.h */
    bool quiet;
    bool skip_absent; /* a scene whose file or data is not there goes into "absent", not an error */
    const struct neph_charts_params *charts; /* NULL: none */
    bool over_time;                          /* the sequence of over_time.h too */
    neph_validate_show *show;                /* NULL: nobody looks */
    void *context;
};

/* Run and measure. NEPH_OK also when gates failed: the document's "verdict" says so. `*document` is
 * the caller's; it is set with NEPH_ERR_INTERRUPTED too: everything finished is in it and in the
 * store, and a new run goes on from there. */
enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               json_t **document, struct neph_diag *diag);

/* The document's table for a terminal, on stdout. */
void neph_validate_print(const json_t *document);

/* Facts about this machine for reports: {"cpu", "cores", "memory_bytes"}. */
json_t *neph_host_json(void);

#endif

/* SPDX-License-Identifier: MIT */
#include "harness/report/vega.h"

#include "base/arena.h"
#include "base/child.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/json_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double time_limit_s = 120.0;

enum neph_status neph_vega_template(const char *name, json_t **spec, struct neph_diag *diag)
{
    char *path = neph_data_path(neph_path_in("scripts/report", name).text);
    enum neph_status status = NEPH_OK;
    *spec = path ? json_load_file(path, 0, NULL) : NULL;
    if (!*spec) {
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "cannot read the chart's template '%s'",
                           path ? path : "?");
        neph_hint(diag, "set NEPH_DATA_DIR to the folder with scenes/ and scripts/");
    }
    free(path);
    return status;
}

enum neph_status neph_vega_write(const json_t *spec, const char *stem, struct neph_diag *diag)
{
    return neph_json_write(spec, JSON_INDENT(1), neph_path_format("%s.vl.json", stem).text, diag);
}

static enum neph_status run_node(const char *const *argv, const char *log_path, bool *drawn,
                                 struct neph_diag *why, struct neph_diag *diag)
{
    const struct neph_child_params params = {
        .argv = argv, .log_path = log_path, .time_limit_s = time_limit_s};
    struct neph_child_result result;
    const enum neph_status status = neph_child_run(&params, &result, why);
    *drawn = !status;
    if (!status)
        unlink(log_path);
    if (status != NEPH_ERR_INTERRUPTED)
        return NEPH_OK;
    if (diag)
        *diag = *why;
    return status;
}

enum neph_status neph_vega_draw(char *const *stems, int count, bool *drawn, struct neph_diag *why,
                                struct neph_diag *diag)
{
    struct neph_arena arena = {.last = NULL};
    const char *argv[2 * NEPH_VEGA_CHARTS_MAX + 3] = {"node"};
    char *script = neph_data_path("scripts/report/render_chart.mjs");
    *drawn = false;
    argv[1] = script;
    for (int i = 0; i < count; i++) {
        argv[2 + 2 * i] = neph_arena_format(&arena, "%s.vl.json", stems[i]);
        argv[3 + 2 * i] = neph_arena_format(&arena, "%s.svg", stems[i]);
        unlink(argv[3 + 2 * i]); /* it may be a hard link to an older report */
    }
    const char *log_path = neph_arena_format(&arena, "%s.log", stems[0]);
    enum neph_status status = script ? neph_arena_check(&arena, diag) : neph_fail_memory(diag);
    if (!status)
        status = run_node(argv, log_path, drawn, why, diag);
    neph_arena_finish(&arena);
    free(script);
    return status;
}

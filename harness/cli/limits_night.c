/* SPDX-License-Identifier: MIT */
#include "harness/cli/limits_night.h"

#include "base/files.h"
#include "base/path.h"
#include "harness/json_file.h"
#include "harness/night/limits.h"
#include "metrics/run_limit.h"

#include <stdio.h>
#include <string.h>

bool neph_cli_are_nightly_runs(const struct neph_cli_shared *shared)
{
    const char *first = shared->operand_count > 0 ? shared->operands[0] : "";
    const size_t length = strlen(first);
    return length > 5 && strcmp(first + length - 5, ".json") == 0;
}

static void print_night(const struct neph_night_limits *limits, const char *path, bool all)
{
    int count = 0;
    for (int i = 0; i < limits->count; i++)
        count += !limits->list[i].because;
    printf("%d limits of %d nightly runs in '%s', %d series without a limit\n", count,
           limits->run_count, path, limits->count - count);
    for (int i = 0; i < limits->count && all; i++) {
        const struct neph_night_limit *limit = &limits->list[i];
        if (limit->because)
            printf("%s: no limit: %s\n", limit->series, limit->because);
        else
            printf("%s: %.5g to %.5g, limit %.5g\n", limit->series, limit->lowest, limit->highest,
                   limit->value);
    }
}

enum neph_status neph_cli_limit_nights(const struct neph_cli_shared *shared, double share,
                                       double confidence, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(shared->output, "limits.json");
    struct neph_night_limits limits = {.share = share, .confidence = confidence};
    if (shared->operand_count < NEPH_RUN_LIMIT_RUNS_MIN)
        return neph_fail(diag, NEPH_ERR_USAGE, "%d nightly runs are named, at least %d are needed",
                         shared->operand_count, NEPH_RUN_LIMIT_RUNS_MIN);
    enum neph_status status = neph_night_limits_measure(shared->operands, shared->operand_count,
                                                        &limits, diag);
    json_t *json = status ? NULL : neph_night_limits_json(&limits);
    if (!status)
        status = neph_dir_create(shared->output, diag);
    if (!status)
        status = neph_json_write(json, JSON_INDENT(1), path.text, diag);
    if (!status && shared->json)
        status = neph_json_print(json_incref(json), diag);
    else if (!status)
        print_night(&limits, path.text, shared->all);
    json_decref(json);
    neph_night_limits_finish(&limits);
    return status;
}

/* SPDX-License-Identifier: MIT
 *
 * `neph validate --suite stress`: the stress tests, their table, DIR/stress.json and
 * DIR/report/index.html.
 */
#include "harness/experiments/validate.h"

#include "base/files.h"
#include "harness/progress.h"
#include "harness/report/report_folder.h"
#include "harness/stress/output.h"
#include "harness/stress/suite.h"

#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_STRESS_IMAGES_COUNT == 4, "a new kind");

enum neph_stress_images neph_stress_images_parse(const char *word)
{
    static const char *const words[NEPH_STRESS_IMAGES_COUNT] = {
        [NEPH_STRESS_IMAGES_FAILED] = "failed",
        [NEPH_STRESS_IMAGES_CHANGED] = "changed",
        [NEPH_STRESS_IMAGES_ALL] = "all",
        [NEPH_STRESS_IMAGES_NONE] = "none",
    };
    int found = 0;
    while (found < NEPH_STRESS_IMAGES_COUNT && strcmp(words[found], word) != 0)
        found++;
    return (enum neph_stress_images)found;
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct neph_validate_request *request = request_;
    request->page.limit_bytes = request->page_limit_mb < 0
                                    ? 60000000
                                    : (size_t)request->page_limit_mb * 1000000;
    request->page_folder = neph_path_join(request->shared.output, "report");
    return request->page_folder ? neph_stress_page_open(request->page_folder, &request->page, diag)
                                : neph_fail_memory(diag);
}

static enum neph_status prepare_by_old_name(void *request, struct neph_diag *diag)
{
    neph_progress_warn("--suite failure is called --suite stress now, and its failure.json "
                       "stress.json; the old word goes with the next release");
    return prepare(request, diag);
}

static enum neph_status judge(const struct neph_stress_suite *suite, struct neph_diag *reason)
{
    if (suite->passes)
        return NEPH_OK;
    if (suite->counts.compared == 0)
        return neph_fail(reason, NEPH_ERR_GATE, "nothing was compared: that is no verdict");
    neph_fail(reason, NEPH_ERR_GATE, "%d of %d results differ from their expectations",
              suite->counts.news, suite->counts.compared);
    neph_hint(reason, "a failure with a cause that is known is an entry of "
                      "scenes/studies/stress_expectations.json, with its reason; a result that "
                      "passes has no entry");
    return NEPH_ERR_GATE;
}

static enum neph_status write_junit(const struct neph_stress_suite *suite, const char *path,
                                    struct neph_diag *diag)
{
    struct neph_junit junit = {.name = "neph validate --suite stress"};
    neph_stress_junit(suite, &junit);
    const enum neph_status status = neph_junit_write(&junit, path, diag);
    neph_junit_finish(&junit);
    return status;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct neph_validate_request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    FILE *text = publication->text;
    struct neph_stress_suite suite = {.scenes = NULL};
    struct neph_stress_params params = {.full = request->tier && strcmp(request->tier, "full") == 0,
                                        .only = request->only.words,
                                        .only_count = request->only.count,
                                        .presets = request->presets.words,
                                        .preset_count = request->presets.count,
                                        .engines = request->engines.words,
                                        .engine_count = request->engines.count,
                                        .width_px = shared->size.width_px,
                                        .height_px = shared->size.height_px,
                                        .on_device = request->on_device,
                                        .jobs = shared->jobs,
                                        .device = run->device,
                                        .quiet = run->quiet,
                                        .page = &request->page};
    if (request->pictures)
        params.pictures = neph_stress_images_parse(request->pictures);
    enum neph_status status = neph_stress_run(&params, run->store, &suite, diag);
    if (status == NEPH_ERR_INTERRUPTED)
        fprintf(stderr, "report so far: %s/index.html\n", request->page_folder);
    if (!status && request->junit)
        status = write_junit(&suite, request->junit, diag);
    if (!status && text)
        status = neph_stress_print(&suite, text, diag);
    if (!status) {
        fprintf(text ? text : stderr, "report: %s/index.html\n", request->page_folder);
        publication->json = neph_stress_json(&suite);
        publication->verdict = judge(&suite, &publication->reason);
    }
    neph_stress_finish(&suite);
    return status;
}

static void finish(void *request_)
{
    struct neph_validate_request *request = request_;
    neph_report_folder_close(request->page.folder);
    free(request->page_folder);
}

const struct neph_experiment neph_experiment_stress = {
    .document = "stress.json", .prepare = prepare, .run = run, .finish = finish};

const struct neph_experiment neph_experiment_stress_by_old_name = {
    .document = "failure.json", .prepare = prepare_by_old_name, .run = run, .finish = finish};

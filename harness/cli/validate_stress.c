/* SPDX-License-Identifier: MIT */
#include "harness/cli/validate_stress.h"

#include "base/files.h"
#include "harness/cli/cli.h"
#include "harness/report/report_folder.h"
#include "harness/stress/output.h"
#include "harness/stress/page.h"

#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STRESS_PICTURES_COUNT == 4, "a new kind");

enum neph_stress_pictures neph_cli_stress_pictures(const char *word)
{
    static const char *const words[NEPH_STRESS_PICTURES_COUNT] = {
        [NEPH_STRESS_PICTURES_FAILED] = "failed",
        [NEPH_STRESS_PICTURES_CHANGED] = "changed",
        [NEPH_STRESS_PICTURES_ALL] = "all",
        [NEPH_STRESS_PICTURES_NONE] = "none",
    };
    int found = 0;
    while (found < NEPH_STRESS_PICTURES_COUNT && strcmp(words[found], word) != 0)
        found++;
    return (enum neph_stress_pictures)found;
}

static enum neph_status write_json(const char *output, const char *name,
                                   const struct neph_stress_suite *suite, struct neph_diag *diag)
{
    char *path = neph_path_join(output, name);
    json_t *document = neph_stress_json(suite);
    char *text = json_dumps(document, JSON_INDENT(1));
    const enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                                 : neph_fail_memory(diag);
    free(text);
    json_decref(document);
    free(path);
    return status;
}

static enum neph_status judge(const struct neph_stress_suite *suite, struct neph_diag *diag)
{
    if (suite->passes)
        return NEPH_OK;
    if (suite->counts.compared == 0)
        return neph_fail(diag, NEPH_ERR_GATE, "nothing was compared: that is no verdict");
    neph_fail(diag, NEPH_ERR_GATE, "%d of %d results are not what is expected of them",
              suite->counts.news, suite->counts.compared);
    neph_hint(diag, "a failure with a cause that is known is an entry of "
                    "scenes/studies/stress_expectations.json, with its reason; what no longer "
                    "fails has none");
    return NEPH_ERR_GATE;
}

static enum neph_status tell(const struct neph_stress_suite *suite, const char *output,
                             const char *document, const char *page_folder, bool as_json,
                             struct neph_diag *diag)
{
    enum neph_status status = write_json(output, document, suite, diag);
    if (!status)
        status = as_json ? neph_json_print(neph_stress_json(suite), diag)
                         : neph_stress_print(suite, stdout, diag);
    if (!status)
        fprintf(as_json ? stderr : stdout, "report: %s/index.html\n", page_folder);
    fflush(stdout); /* before what is told of the verdict */
    return status ? status : judge(suite, diag);
}

enum neph_status neph_cli_validate_stress(struct neph_stress_params *params, const char *output,
                                          const char *document, size_t page_limit_bytes,
                                          bool as_json, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_stress_page page = {.limit_bytes = page_limit_bytes};
    struct neph_stress_suite suite = {.scenes = NULL};
    char *store_folder = neph_path_join(output, "store");
    char *page_folder = neph_path_join(output, "report");
    enum neph_status status = store_folder && page_folder
                                  ? neph_stress_page_open(page_folder, &page, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(store_folder, &store, diag);
    params->show = neph_stress_page_publish;
    params->context = &page;
    if (!status)
        status = neph_stress_run(params, store, &suite, diag);
    if (!status)
        status = tell(&suite, output, document, page_folder, as_json, diag);
    else if (status == NEPH_ERR_INTERRUPTED)
        fprintf(stderr, "report so far: %s/index.html\n", page_folder);
    neph_stress_finish(&suite);
    neph_store_close(store);
    neph_report_folder_close(page.folder);
    free(store_folder);
    free(page_folder);
    return status;
}

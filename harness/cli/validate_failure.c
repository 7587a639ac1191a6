/* SPDX-License-Identifier: MIT */
#include "harness/cli/validate_failure.h"

#include "base/files.h"
#include "harness/cli/cli.h"
#include "harness/failure/output.h"

#include <stdlib.h>
#include <string.h>

static enum neph_status write_json(const char *output, const struct neph_failure_suite *suite,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(output, "failure.json");
    json_t *document = neph_failure_json(suite);
    char *text = json_dumps(document, JSON_INDENT(1));
    const enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                                 : neph_fail_memory(diag);
    free(text);
    json_decref(document);
    free(path);
    return status;
}

static enum neph_status judge(const struct neph_failure_suite *suite, struct neph_diag *diag)
{
    if (suite->passes)
        return NEPH_OK;
    if (suite->counts.compared == 0)
        return neph_fail(diag, NEPH_ERR_GATE, "nothing was compared: that is no verdict");
    neph_fail(diag, NEPH_ERR_GATE, "%d of %d results are not what is expected of them",
              suite->counts.news, suite->counts.compared);
    neph_hint(diag, "a failure with a cause that is known is an entry of "
                    "scenes/studies/failure_expectations.json, with its reason; what no longer "
                    "fails has none");
    return NEPH_ERR_GATE;
}

static enum neph_status tell(const struct neph_failure_suite *suite, const char *output,
                             bool as_json, struct neph_diag *diag)
{
    enum neph_status status = write_json(output, suite, diag);
    if (!status && as_json)
        status = neph_cli_print_json(neph_failure_json(suite), diag);
    else if (!status)
        neph_failure_print(suite, stdout);
    return status ? status : judge(suite, diag);
}

enum neph_status neph_cli_validate_failure(const struct neph_failure_params *params,
                                           const char *output, bool as_json, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_failure_suite suite = {.scenes = NULL};
    char *folder = neph_path_join(output, "store");
    enum neph_status status = folder ? neph_store_open(folder, &store, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_failure_run(params, store, &suite, diag);
    if (!status)
        status = tell(&suite, output, as_json, diag);
    neph_failure_finish(&suite);
    neph_store_close(store);
    free(folder);
    return status;
}

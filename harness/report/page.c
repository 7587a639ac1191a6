/* SPDX-License-Identifier: MIT */
#include "harness/report/page.h"

#include "base/files.h"
#include "harness/data.h"

#include <stdlib.h>
#include <string.h>

const struct neph_page_file neph_page_vendored[] = {
    {"node_modules/vega/build/vega.min.js", "vendor/vega.min.js"},
    {"node_modules/vega-lite/build/vega-lite.min.js", "vendor/vega-lite.min.js"},
    {"node_modules/vega-embed/build/vega-embed.min.js", "vendor/vega-embed.min.js"},
    {"vendor-licences.txt", "vendor/LICENSES.txt"},
    {NULL, NULL},
};

static char *source_path(const char *from)
{
    char *name = neph_path_join("scripts/report", from);
    char *path = name ? neph_data_path(name) : NULL;
    free(name);
    return path;
}

bool neph_page_vendor_is_installed(void)
{
    bool installed = true;
    for (const struct neph_page_file *file = neph_page_vendored; file->from; file++) {
        char *path = source_path(file->from);
        installed &= path && neph_path_exists(path);
        free(path);
    }
    return installed;
}

enum neph_status neph_page_copy(const char *folder, const struct neph_page_file *files,
                                struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (const struct neph_page_file *file = files; file->from && !status; file++) {
        char *from = source_path(file->from), *to = neph_path_join(folder, file->to);
        status = from && to ? neph_file_copy(from, to, diag) : neph_fail_memory(diag);
        free(from);
        free(to);
    }
    return status;
}

/* "</script>" and friends cannot end the script early: '<' is written as an escape. */
static char *escape_for_script(const char *json)
{
    size_t extra = 0;
    for (const char *c = json; *c; c++)
        extra += *c == '<' ? 5 : 0;
    char *escaped = malloc(strlen(json) + extra + 1), *out = escaped;
    if (!escaped)
        return NULL;
    for (const char *c = json; *c; c++) {
        if (*c == '<')
            out = stpcpy(out, "\\u003c");
        else
            *out++ = *c;
    }
    *out = '\0';
    return escaped;
}

enum neph_status neph_page_write_data(const char *folder, const char *variable,
                                      const json_t *document, struct neph_diag *diag)
{
    char *json = json_dumps(document, JSON_INDENT(1));
    char *escaped = json ? escape_for_script(json) : NULL;
    char *script = escaped ? neph_format("window.%s = %s;\n", variable, escaped) : NULL;
    char *json_path = neph_path_join(folder, "data.json");
    char *script_path = neph_path_join(folder, "data.js");
    enum neph_status status = script && json_path && script_path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(json_path, json, strlen(json), diag);
    if (!status)
        status = neph_file_write(script_path, script, strlen(script), diag);
    free(json);
    free(escaped);
    free(script);
    free(json_path);
    free(script_path);
    return status;
}

enum neph_status neph_page_publish(const struct neph_report_folder *folder, const char *variable,
                                   const json_t *document, struct neph_diag *diag)
{
    struct neph_scratch *fresh = NULL;
    enum neph_status status = neph_report_folder_begin(folder, &fresh, diag);
    if (!status)
        status = neph_page_write_data(neph_scratch_path(fresh), variable, document, diag);
    if (!status)
        status = neph_report_folder_exchange(folder, fresh, diag);
    neph_scratch_destroy(fresh);
    return status;
}

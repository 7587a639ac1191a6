/* SPDX-License-Identifier: MIT */
#include "harness/report/page.h"

#include "base/files.h"
#include "base/path.h"
#include "base/written.h"
#include "harness/data.h"
#include "metrics/display.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Files of scripts/report/, some with another name in a page's folder. */
static const char *const shared[] = {"report.css", "page.js"};
static const char *const vendored[][2] = {
    {"node_modules/vega/build/vega.min.js", "vendor/vega.min.js"},
    {"node_modules/vega-lite/build/vega-lite.min.js", "vendor/vega-lite.min.js"},
    {"node_modules/vega-embed/build/vega-embed.min.js", "vendor/vega-embed.min.js"},
    {"vendor-licences.txt", "vendor/LICENSES.txt"},
};
enum {
    SHARED_COUNT = sizeof(shared) / sizeof(shared[0]),
    VENDORED_COUNT = sizeof(vendored) / sizeof(vendored[0])
};

static bool is_installed(const char *source)
{
    bool installed = true;
    for (int i = 0; i < VENDORED_COUNT; i++)
        installed &= neph_page_file_size(source, vendored[i][0]) > 0;
    return installed;
}

enum neph_status neph_page_copy(const char *from, const char *name, const char *folder,
                                const char *as, struct neph_diag *diag)
{
    return neph_file_copy(neph_path_in(from, name).text, neph_path_in(folder, as).text, diag);
}

static const char *name_of(const struct neph_page_parts *parts, int file)
{
    return file == 0 ? "index.html" : parts->files[file];
}

enum neph_status neph_page_start(const char *folder, const struct neph_page_parts *parts,
                                 bool *is_interactive, struct neph_diag *diag)
{
    char *source = neph_data_path("scripts/report");
    enum neph_status status = source ? NEPH_OK : neph_fail_memory(diag);
    if (is_interactive)
        *is_interactive = source && is_installed(source);
    for (int i = 0; i < NEPH_PAGE_FOLDERS_MAX && parts->folders[i] && !status; i++)
        status = neph_dir_create(neph_path_in(folder, parts->folders[i]).text, diag);
    for (int i = 0; i < NEPH_PAGE_FILES_MAX && parts->files[i] && !status; i++)
        status = neph_page_copy(source, parts->files[i], folder, name_of(parts, i), diag);
    for (int i = 0; i < SHARED_COUNT && !status; i++)
        status = neph_page_copy(source, shared[i], folder, shared[i], diag);
    for (int i = 0; i < VENDORED_COUNT && !status && is_interactive && *is_interactive; i++)
        status = neph_page_copy(source, vendored[i][0], folder, vendored[i][1], diag);
    free(source);
    return status;
}

size_t neph_page_file_size(const char *folder, const char *name)
{
    struct stat info;
    return stat(neph_path_in(folder, name).text, &info) == 0 ? (size_t)info.st_size : 0;
}

size_t neph_page_size(const char *folder, const struct neph_page_parts *parts)
{
    size_t sum = 0;
    for (int i = 0; i < NEPH_PAGE_FILES_MAX && parts->files[i]; i++)
        sum += neph_page_file_size(folder, name_of(parts, i));
    for (int i = 0; i < SHARED_COUNT; i++)
        sum += neph_page_file_size(folder, shared[i]);
    return sum;
}

json_t *neph_page_difference_colours(void)
{
    const struct neph_display_legend *legend = neph_display_difference_legend();
    json_t *colours = json_array();
    for (int i = 0; i < legend->stop_count; i++) {
        const uint8_t *rgb = legend->stops[i].rgb;
        neph_json_add(&colours, json_sprintf("#%02x%02x%02x", rgb[0], rgb[1], rgb[2]));
    }
    return colours;
}

struct script {
    const char *variable, *json;
};

/* "</script>" and friends cannot end the script early: '<' is written as an escape. */
static void write_script(const void *script_, FILE *out)
{
    const struct script *script = script_;
    const char *json = script->json;
    fprintf(out, "window.%s = ", script->variable);
    for (size_t plain; *json; json += plain + (json[plain] == '<')) {
        plain = strcspn(json, "<");
        fprintf(out, "%.*s%s", (int)plain, json, json[plain] ? "\\u003c" : "");
    }
    fputs(";\n", out);
}

enum neph_status neph_page_write_data(const char *folder, const char *variable,
                                      const json_t *document, struct neph_diag *diag)
{
    const struct script script = {variable, json_dumps(document, JSON_INDENT(1))};
    char *text = NULL;
    enum neph_status status = script.json ? neph_written(write_script, &script, &text, diag)
                                          : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, "data.json").text, script.json,
                                 strlen(script.json), diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, "data.js").text, text, strlen(text), diag);
    free((char *)script.json);
    free(text);
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

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

/* Files of scripts/report/. The second name is the file's name in the page's folder. */
static const char *const shared[] = {"report.css", "page.js"}; /* loaded by page.html */
static const char *const vendored[][2] = {
    {"node_modules/vega/build/vega.min.js", "vendor/vega.min.js"},
    {"node_modules/vega-lite/build/vega-lite.min.js", "vendor/vega-lite.min.js"},
    {"node_modules/vega-embed/build/vega-embed.min.js", "vendor/vega-embed.min.js"},
    {"vendor-licences.txt", "vendor/LICENSES.txt"},
};
enum {
    SHARED_COUNT = sizeof(shared) / sizeof(shared[0]),
    VENDORED_COUNT = sizeof(vendored) / sizeof(vendored[0]),
    PART_BYTES_MAX = 1 << 20
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

/* ---- index.html ------------------------------------------------------------------------------ */

struct index {
    const struct neph_page_parts *parts;
    const char *shell; /* template with @title@, @files@ and @words@ */
    const char *words; /* replacement of @words@ */
};

/* The HTML element that loads a file of the page. */
static void print_file(const char *name, FILE *out)
{
    const char *extension = strrchr(name, '.');
    if (extension && strcmp(extension, ".css") == 0)
        fprintf(out, "<link rel=\"stylesheet\" href=\"%s\">\n", name);
    else
        fprintf(out, "<script src=\"%s\" defer></script>\n", name);
}

static void print_part(const struct index *index, const char *name, FILE *out)
{
    if (strncmp(name, "title@", 6) == 0)
        fputs(index->parts->title, out);
    else if (strncmp(name, "words@", 6) == 0)
        fputs(index->words, out);
    else
        for (int i = 1; i < NEPH_PAGE_FILES_MAX && index->parts->files[i]; i++)
            print_file(index->parts->files[i], out);
}

static void print_index(const void *index_, FILE *out)
{
    const struct index *index = index_;
    const char *from = index->shell;
    for (const char *at; (at = strchr(from, '@')) && strchr(at + 1, '@');) {
        fwrite(from, 1, (size_t)(at - from), out);
        print_part(index, at + 1, out);
        from = strchr(at + 1, '@') + 1;
    }
    fputs(from, out);
}

static enum neph_status write_index(const char *source, const char *folder,
                                    const struct neph_page_parts *parts, struct neph_diag *diag)
{
    char *shell = NULL, *words = NULL, *text = NULL;
    size_t size;
    enum neph_status status = neph_file_read(neph_path_in(source, "page.html").text, PART_BYTES_MAX,
                                             &shell, &size, diag);
    if (!status)
        status = neph_file_read(neph_path_in(source, parts->files[0]).text, PART_BYTES_MAX, &words,
                                &size, diag);
    const struct index index = {parts, shell, words};
    if (!status)
        status = neph_write_to_text(print_index, &index, &text, diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, "index.html").text, text, strlen(text), diag);
    free(shell);
    free(words);
    free(text);
    return status;
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
    if (!status)
        status = write_index(source, folder, parts, diag);
    for (int i = 1; i < NEPH_PAGE_FILES_MAX && parts->files[i] && !status; i++)
        status = neph_page_copy(source, parts->files[i], folder, parts->files[i], diag);
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
        sum += neph_page_file_size(folder, i == 0 ? "index.html" : parts->files[i]);
    for (int i = 0; i < SHARED_COUNT; i++)
        sum += neph_page_file_size(folder, shared[i]);
    return sum;
}

static json_t *colour_json(const uint8_t rgb[3])
{
    return json_sprintf("#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
}

json_t *neph_page_colours(const struct neph_display_legend *legend)
{
    json_t *colours = json_array();
    for (int i = 0; i < legend->stop_count; i++)
        neph_json_add(&colours, colour_json(legend->stops[i].rgb));
    return colours;
}

json_t *neph_page_difference_colours(void)
{
    return neph_page_colours(neph_display_difference_legend());
}

json_t *neph_page_colours_beyond(const struct neph_display_legend *legend)
{
    return json_pack("{s:o, s:o, s:o}", "below", colour_json(legend->below), "above",
                     colour_json(legend->above), "not_a_number", colour_json(legend->not_a_number));
}

struct script {
    const char *variable, *json;
};

/* Write '<' as an escape, so that a "</script>" in the data cannot end the script. */
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
    char *readable = json_dumps(document, JSON_INDENT(1)), *text = NULL;
    const struct script script = {variable, json_dumps(document, JSON_COMPACT)};
    enum neph_status status = readable && script.json
                                  ? neph_write_to_text(write_script, &script, &text, diag)
                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, "data.json").text, readable, strlen(readable),
                                 diag);
    if (!status)
        status = neph_file_write(neph_path_in(folder, "data.js").text, text, strlen(text), diag);
    free((char *)script.json);
    free(readable);
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

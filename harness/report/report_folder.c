/* SPDX-License-Identifier: MIT */
#include "harness/report/report_folder.h"

#include "base/files.h"
#include "base/owned.h"
#include "base/path.h"
#include "harness/json.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* renameat2 with RENAME_EXCHANGE swaps two folders in one step. */
#ifndef RENAME_EXCHANGE
#define RENAME_EXCHANGE (1 << 1)
#endif

static const char prefix[] = ".neph-report-";
static const int exchange_tries = 16; /* attempts to exchange the folders; two runs that both
                                         publish a first report need two */

struct neph_report_folder {
    char *place;  /* path of the report, symbolic links resolved */
    char *parent; /* its parent folder */
    struct neph_scratch *work;
};

/* ---- ownership of a folder ------------------------------------------------------------------- */

/* True for an entry of a report from before ownership markers. */
static bool is_part(const char *name)
{
    static const char *const parts[] = {".",       "..",        "index.html", "report.css",
                                        "page.js", "report.js", "data.js",    "data.json",
                                        "images",  "charts",    "vendor"};
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        if (strcmp(name, parts[i]) == 0)
            return true;
    return false;
}

static bool has_only_report_parts(const char *folder)
{
    DIR *directory = opendir(folder);
    bool alone = directory != NULL;
    for (const struct dirent *entry; alone && (entry = readdir(directory));)
        alone = is_part(entry->d_name);
    if (directory)
        closedir(directory);
    return alone;
}

static bool has_data(const char *folder)
{
    json_t *data = json_load_file(neph_path_in(folder, "data.json").text, 0, NULL);
    const bool ours = strcmp(neph_json_text(data, "format"), "neph-report-1") == 0;
    json_decref(data);
    return ours;
}

static bool is_old_report(const char *folder)
{
    return has_only_report_parts(folder) && has_data(folder);
}

static const struct neph_owned_kind report_kind = {
    .name = "report", .version = 1, .is_old = is_old_report};

/* ---- opening --------------------------------------------------------------------------------- */

static char *copy_parent_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

static enum neph_status find_place(const char *folder, struct neph_report_folder *opened,
                                   struct neph_diag *diag)
{
    opened->place = realpath(folder, NULL);
    if (!opened->place)
        opened->place = strdup(folder); /* not there yet */
    opened->parent = opened->place ? copy_parent_path(opened->place) : NULL;
    return opened->parent ? NEPH_OK : neph_fail_memory(diag);
}

enum neph_status neph_report_folder_open(const char *folder, struct neph_report_folder **opened,
                                         struct neph_diag *diag)
{
    struct neph_report_folder *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    enum neph_status status = neph_owned_check(folder, &report_kind, diag);
    if (!status)
        status = find_place(folder, made, diag);
    if (!status)
        status = neph_dir_create(made->parent, diag);
    if (!status) {
        neph_scratch_sweep(made->parent, prefix);
        status = neph_scratch_create(made->parent, prefix, &made->work, diag);
    }
    if (status) {
        neph_report_folder_close(made);
        return status;
    }
    *opened = made;
    return NEPH_OK;
}

void neph_report_folder_close(struct neph_report_folder *folder)
{
    if (!folder)
        return;
    neph_scratch_destroy(folder->work);
    free(folder->place);
    free(folder->parent);
    free(folder);
}

const char *neph_report_folder_work(const struct neph_report_folder *folder)
{
    return neph_scratch_path(folder->work);
}

/* ---- publishing ------------------------------------------------------------------------------ */

static enum neph_status link_tree(const char *from, const char *to, struct neph_diag *diag);

static enum neph_status link_entry(const char *from, const char *to, struct neph_diag *diag)
{
    if (neph_path_is_dir(from)) {
        const enum neph_status status = neph_dir_create(to, diag);
        return status ? status : link_tree(from, to, diag);
    }
    if (link(from, to) == 0)
        return NEPH_OK;
    return neph_file_copy(from, to, diag); /* the file system has no hard links */
}

/* Link all files of a folder into another folder. */
static enum neph_status link_tree(const char *from, const char *to, struct neph_diag *diag)
{
    DIR *directory = opendir(from);
    enum neph_status status = NEPH_OK;
    if (!directory)
        return neph_fail(diag, NEPH_ERR_IO, "cannot open '%s': %s", from, strerror(errno));
    for (const struct dirent *entry; !status && (entry = readdir(directory));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        status = link_entry(neph_path_in(from, entry->d_name).text,
                            neph_path_in(to, entry->d_name).text, diag);
    }
    closedir(directory);
    return status;
}

enum neph_status neph_report_folder_take(const struct neph_report_folder *folder, const char *name,
                                         bool *is_there, struct neph_diag *diag)
{
    const struct neph_path from = neph_path_in(folder->parent, name);
    const struct neph_path to = neph_path_in(neph_report_folder_work(folder), name);
    enum neph_status status = NEPH_OK;
    const bool found = neph_path_exists(neph_path_in(from.text, "index.html").text) &&
                       neph_path_exists(neph_path_in(from.text, ".neph-owned").text);
    if (found)
        status = neph_dir_create(to.text, diag);
    if (!status && found)
        status = link_tree(from.text, to.text, diag);
    if (!status)
        *is_there = found;
    return status;
}

enum neph_status neph_report_folder_begin(const struct neph_report_folder *folder,
                                          struct neph_scratch **fresh, struct neph_diag *diag)
{
    struct neph_scratch *made = NULL;
    enum neph_status status = neph_scratch_create(folder->parent, prefix, &made, diag);
    if (!status)
        status = neph_owned_claim(neph_scratch_path(made), &report_kind, diag);
    if (!status)
        status = link_tree(neph_scratch_path(folder->work), neph_scratch_path(made), diag);
    if (status) {
        neph_scratch_destroy(made);
        return status;
    }
    *fresh = made;
    return NEPH_OK;
}

static bool swap(const char *a, const char *b)
{
    return renameat2(AT_FDCWD, a, AT_FDCWD, b, RENAME_EXCHANGE) == 0;
}

/* Move `fresh` to the place of the report. `*swapped` is true when a folder was there, which is now
 * at `fresh`. */
static bool put_in_place(const char *fresh, const char *place, bool *swapped)
{
    for (int i = 0; i < exchange_tries; i++) {
        *swapped = swap(fresh, place);
        if (*swapped)
            return true;
        if (errno != ENOENT)
            return false;
        if (rename(fresh, place) == 0)
            return true;
        if (errno != EEXIST && errno != ENOTEMPTY) /* another run has just published */
            return false;
    }
    return false;
}

enum neph_status neph_report_folder_exchange(const struct neph_report_folder *folder,
                                             const struct neph_scratch *fresh,
                                             struct neph_diag *diag)
{
    const char *path = neph_scratch_path(fresh);
    bool swapped;
    if (!put_in_place(path, folder->place, &swapped))
        return neph_fail(diag, NEPH_ERR_IO, "cannot put the report at '%s': %s", folder->place,
                         strerror(errno));
    /* If the place now contains foreign files, written after the check at the start, put them
     * back. */
    if (swapped && neph_owned_check(path, &report_kind, NULL) && swap(path, folder->place)) {
        const enum neph_status status = neph_owned_check(folder->place, &report_kind, diag);
        return status ? status
                      : neph_fail(diag, NEPH_ERR_IO, "'%s' changed while the report was written",
                                  folder->place);
    }
    return neph_file_sync(folder->parent, diag);
}
